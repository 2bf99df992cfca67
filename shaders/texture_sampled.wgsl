// Tables as sampled textures: for devices with few storage textures.
// needs: texels

alias Table = texture_2d<u32>;
alias PairTable = texture_2d<u32>;
alias WordTable = texture_2d<u32>;

fn texel_at(table: Table, index: u32) -> vec4<u32> {
    return textureLoad(table, place_of_texel(index), 0);
}

fn pair_at(table: PairTable, index: u32) -> vec2<u32> {
    return textureLoad(table, place_of_texel(index), 0).xy;
}

fn word_at(table: WordTable, index: u32) -> u32 {
    return textureLoad(table, place_of_texel(index), 0).x;
}
