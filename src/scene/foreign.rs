//! Files that are no scene at all: one word says more about them than an error a line.

/// How files of other kinds begin.
const KINDS: [(&[u8], &str); 25] = [
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"GIF8", "a GIF picture"),
    (b"BM", "a BMP picture"),
    (b"II*\0", "a TIFF picture"),
    (b"MM\0*", "a TIFF picture"),
    (b"RIFF", "a WebP picture, a film or a sound"),
    (b"\x76\x2f\x31\x01", "an OpenEXR picture"),
    (b"P1", "a PBM picture"),
    (b"P2", "a PGM picture"),
    (b"P3", "a PPM picture"),
    (b"P4", "a PBM picture"),
    (b"P5", "a PGM picture"),
    (b"P6", "a PPM picture"),
    (b"P7", "a PAM picture"),
    (b"PF", "a PFM picture"),
    (b"Pf", "a PFM picture"),
    (b"%PDF-", "a PDF document"),
    (b"PK\x03\x04", "a ZIP archive or an office document"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"BZh", "a bzip2 archive"),
    (b"\xfd7zXZ", "an xz archive"),
    (b"\x28\xb5\x2f\xfd", "a Zstandard archive"),
    (b"\x7fELF", "a program"),
    (b"MZ", "a program"),
];

/// Kinds whose first letters a text may have as well: what follows them must be no letter, or hold a zero.
const LETTERS: usize = 2;
const HEADER: usize = 16;

/// So far a text has no zero byte.
const LOOKED_AT: usize = 8192;

/// What kind of file `text` is, if it cannot be a scene: a picture, another known kind, or binary data.
pub fn foreign_kind(text: &[u8]) -> Option<&'static str> {
    let has_zero = |length: usize| text[..text.len().min(length)].contains(&0);
    let ends = |magic: &[u8]| {
        let next = text.get(magic.len());
        magic.len() > LETTERS || has_zero(HEADER) || next.is_none_or(|byte| !byte.is_ascii_alphanumeric())
    };
    let known = KINDS.iter().find(|(magic, _)| text.starts_with(magic) && ends(magic));
    let is_utf16 = text.starts_with(b"\xFF\xFE") || text.starts_with(b"\xFE\xFF");
    let is_binary = || !is_utf16 && has_zero(LOOKED_AT);
    known.map(|&(_, kind)| kind).or_else(|| is_binary().then_some("binary data"))
}
