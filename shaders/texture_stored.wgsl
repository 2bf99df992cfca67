// Tables as storage textures: software devices load from them with a third of the instructions that they take for
// the level of a sampled one.
// needs: texels

alias Table = texture_storage_2d<rgba32uint, read>;
alias PairTable = texture_storage_2d<rg32uint, read>;
alias WordTable = texture_storage_2d<r32uint, read>;

fn texel_at(table: Table, index: u32) -> vec4<u32> {
    return textureLoad(table, place_of_texel(index));
}

fn pair_at(table: PairTable, index: u32) -> vec2<u32> {
    return textureLoad(table, place_of_texel(index)).xy;
}

fn word_at(table: WordTable, index: u32) -> u32 {
    return textureLoad(table, place_of_texel(index)).x;
}
