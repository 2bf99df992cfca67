//! The element of an atom by its name, where a file says nothing better.

use super::elements::Element;

/// Names of ions in CHARMM that are no symbols.
const IONS: [(&[u8], &[u8]); 9] = [
    (b"SOD", b"NA"),
    (b"CLA", b"CL"),
    (b"POT", b"K"),
    (b"CES", b"CS"),
    (b"CAL", b"CA"),
    (b"LIT", b"LI"),
    (b"RUB", b"RB"),
    (b"BAR", b"BA"),
    (b"IOD", b"I"),
];
/// Symbols with which no usual name of an atom of another element begins.
const CERTAIN: [&[u8]; 18] = [
    b"CL", b"BR", b"FE", b"ZN", b"MG", b"MN", b"CU", b"SI", b"SE", b"LI", b"AL", b"AG", b"AU", b"NI", b"PD", b"PT",
    b"RU", b"RH",
];
/// Residues whose names of atoms begin with a symbol of one letter: amino acids, nucleotides, water.
const USUAL: [&str; 56] = [
    "ALA", "ARG", "ASN", "ASP", "CYS", "GLN", "GLU", "GLY", "HIS", "ILE", "LEU", "LYS", "MET", "PHE", "PRO", "SER",
    "THR", "TRP", "TYR", "VAL", "ASH", "ASX", "CYM", "CYX", "GLH", "GLX", "HID", "HIE", "HIP", "HSD", "HSE", "HSP",
    "LYN", "MSE", "SEC", "ACE", "NME", "NMA", "A", "C", "G", "U", "T", "I", "DA", "DC", "DG", "DT", "DU", "HOH", "WAT",
    "TIP", "TIP3", "SOL", "SPC", "H2O",
];
/// What names of atoms that have no residue may begin with.
const LETTERS: &[u8] = b"HCNOSP";

/// The symbol of an atom of a residue. `name` is a field of four columns, of which the first is blank before a symbol of one letter.
pub(super) fn symbol(name: &[u8], residue: &[u8]) -> Vec<u8> {
    let full = name.trim_ascii().to_ascii_uppercase();
    let residue = residue.to_ascii_uppercase();
    let (bare, bare_residue) = (without_charge(&full), without_charge(&residue));
    let is_ion = residue == full || bare_residue == bare || residue == b"ION";
    let named = |name: &[u8]| IONS.iter().find(|(ion, _)| *ion == name).map(|(_, symbol)| *symbol);
    if let Some(symbol) = named(&residue).filter(|symbol| residue == full || *symbol == bare) {
        return symbol.to_vec();
    }
    let is_usual = str::from_utf8(&residue).is_ok_and(|residue| USUAL.contains(&residue));
    if is_ion && !is_usual && Element::of(bare).is_some() {
        return bare.to_vec();
    }
    if let Some(symbol) = CERTAIN.iter().find(|symbol| full.starts_with(symbol)) {
        return symbol.to_vec();
    }
    let is_two = !is_usual && name[0] != b'H' && name[..2].iter().all(u8::is_ascii_alphabetic);
    if is_two && Element::of(&name[..2]).is_some() {
        return name[..2].to_vec();
    }
    match full.iter().find(|byte| byte.is_ascii_alphabetic()) {
        Some(&letter) => vec![letter],
        None => full,
    }
}

/// The element of an atom's name that is no symbol, such as `OH2`; none of what may be something else.
pub(super) fn guess(name: &[u8]) -> Option<&'static Element> {
    let name = name.to_ascii_uppercase();
    let symbol = CERTAIN.iter().find(|symbol| name.starts_with(symbol)).copied();
    let letter = name.first().filter(|letter| LETTERS.contains(letter)).map(std::slice::from_ref);
    Element::of(symbol.or(letter)?)
}

/// A name without the number or the sign at its end.
fn without_charge(name: &[u8]) -> &[u8] {
    let end = name.iter().rposition(|byte| !matches!(byte, b'0'..=b'9' | b'+' | b'-'));
    &name[..end.map_or(0, |end| end + 1)]
}
