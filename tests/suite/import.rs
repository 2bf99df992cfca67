//! Files of particles as scenes: what is read, what is refused and in which words, radii, colours, camera and lights.

use std::process::{Command, Output, Stdio};

use trueray::DVec3;
use trueray::import::{Coloring, Format, Frames, Framing, Import, Imported, Lighting, Map, Options, Radius, scene};
use trueray::scene::{Diagnostic, Scene, Severity, parse};
use trueray::view::View;

use crate::support::root;

const WATER: &str = "3\nwater\nO 0 0 0.25\nH 0.5 0.75 -0.5\nH 0 -0.75 -0.5 7\n";
const DUMP: &str = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 10\n0 10\n0 10\n\
                    ITEM: ATOMS id type x y z q\n1 1 1 2 3 -0.5\n2 2 4 6 8 0.5\n";
const PDB: &str = "HEADER    TEST\n\
    ATOM      1  CA  GLY A   1       1.000   2.000   3.000  1.00 10.00           C\n\
    HETATM    2 CA    CA A   2       5.000   6.500   7.000  1.00 30.00\n\
    ATOM      3 HG11 VAL B   3      -1.000   0.000   2.500  1.00 20.00\nEND\n";
const CIF: &str = "data_X\n_cell.length_a 1\ntext\n;\n_atom_site.no no\n;\nloop_\n_atom_site.id\n_atom_site.type_symbol\n\
    _atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n_atom_site.label\n_atom_site.pdbx_PDB_model_num\n\
    1 C 1 2 3 \"O5'\" 1\n2 N 1.5 2 3 'a b' 1\n1 C 4 5 6 x 2\n2 N 4 5 8 x 2\n#\n";
const TABLE: &str = "x,y,z,radius,r,g,b,speed,name\n1,2,3,0.5,255,0,0,1.5,a\n\"4\", 5 ,6,0.25,0,51,0,2.5,\"b,\"\"c\"\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment none\nelement camera 1\nproperty float f\nelement vertex 2\n\
    property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
    property double radius\nend_header\n9\n1 2 3 255 0 0 0.5\n4 5 6 0 0 51 0.25\n";

const FACE: &str = "element face 1\nproperty list uchar int vertex_indices\n";

fn import(text: impl AsRef<[u8]>, options: &Options) -> Vec<Imported> {
    let text = text.as_ref();
    Import::new("file", Format::of(text).expect("a known format"), text, options.clone()).collect()
}

/// The scene of a text in which nothing is wrong or unusual.
#[track_caller]
fn read_with(text: impl AsRef<[u8]>, options: &Options) -> Scene {
    let [Imported { parsed, .. }] = &import(text, options)[..] else { panic!("one frame is expected") };
    assert_eq!(parsed.diagnostics, [], "{}", parsed.report(false));
    let scene = parsed.scene.clone().unwrap();
    scene.check().unwrap();
    let again = parse("again", scene.to_string().as_bytes()).scene.unwrap();
    let numbers = |scene: &Scene| (scene.window, scene.spheres.clone(), scene.lights.clone(), scene.background);
    assert!(numbers(&again) == numbers(&scene), "other numbers are read back");
    scene
}

#[track_caller]
fn read(text: impl AsRef<[u8]>) -> Scene {
    read_with(text, &Options::default())
}

/// The first diagnostic of a text.
#[track_caller]
fn fault_with(text: impl AsRef<[u8]>, options: &Options) -> Diagnostic {
    let imported = import(text, options);
    let parsed = &imported.last().unwrap().parsed;
    assert!(parsed.scene.is_none(), "a scene in spite of {}", parsed.report(false));
    parsed.diagnostics.iter().find(|found| found.severity == Severity::Error).unwrap().clone()
}

/// A wrong text, and of its first error the line, column, token and a part of the message.
type Fault<'a> = (&'a str, usize, usize, &'a str, &'a str);

/// Tells all of what differs.
#[track_caller]
fn assert_faults(faults: &[Fault]) {
    let wrong = faults.iter().filter_map(|&(text, line, column, token, message)| {
        let fault = fault_with(text, &Options::default());
        let found = (fault.line, fault.column, &*fault.token);
        let is_right = found == (line, column, token) && fault.message.contains(message);
        (!is_right).then(|| format!("{found:?} {}, not {:?} {message}", fault.message, (line, column, token)))
    });
    let wrong: Vec<_> = wrong.collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Where the first sphere is in the file tells where all are: the scene is moved as one body.
#[track_caller]
fn assert_positions(scene: &Scene, positions: &[[f64; 3]]) {
    assert_eq!(scene.spheres.len(), positions.len());
    let moved = scene.spheres[0].center - DVec3::from(positions[0]);
    for (sphere, &position) in scene.spheres.iter().zip(positions) {
        let error = sphere.center - moved - DVec3::from(position);
        assert!(error.length() < 1e-12, "{position:?} is at {}", sphere.center - moved);
    }
}

fn radii(scene: &Scene) -> Vec<f64> {
    scene.spheres.iter().map(|sphere| sphere.scale.x).collect()
}

fn colors(scene: &Scene) -> Vec<[f64; 3]> {
    scene.spheres.iter().map(|sphere| sphere.color.to_array()).collect()
}

fn names(scene: &Scene) -> Vec<&str> {
    (0..scene.sphere_names.len()).map(|index| scene.sphere_names.get(index)).collect()
}

fn bytes(rgb: [u8; 3]) -> [f64; 3] {
    rgb.map(|level| f64::from(level) / 255.0)
}

fn file(name: &str) -> Vec<u8> {
    std::fs::read(root().join("tests/import").join(name)).unwrap()
}

fn by(source: &str) -> Options {
    Options { coloring: source.parse().unwrap(), ..Options::default() }
}

#[test]
fn formats_are_told_by_what_they_begin_with() {
    let all = [
        (WATER, Format::Xyz),
        (DUMP, Format::Lammps),
        (PDB, Format::Pdb),
        (CIF, Format::Mmcif),
        (TABLE, Format::Table),
        (PLY, Format::Ply),
        ("\u{FEFF}\n# made by hand\nx;y;z\n1;2;3\n", Format::Table),
        ("x\ty\tz\r\n1\t2\t3\r\n", Format::Table),
        (",x,y,z\n0,1,2,3\n", Format::Table),
        ("0.5 1 2\n3 4 5\n", Format::Table),
        ("1\n0.5 1 2 9 0 0 255\n", Format::Table),
        ("1\n10 10 10\n1 1 2 3\n", Format::Xyz),
    ];
    for (text, format) in all {
        assert_eq!(Format::of(text.as_bytes()), Some(format), "{text}");
        assert!(!import(text, &Options::default()).is_empty());
    }
    let scenes =
        ["NEAR 1\nLEFT -1\n", "# x,y,z\nNEAR 1", "OUTPUT\ta\tb\n", "", "TP 1\n", "{\"x\": a, \"y\": b, \"z\": c}", "7"];
    for text in scenes {
        assert_eq!(Format::of(text.as_bytes()), None, "{text}");
    }
}

#[test]
fn each_format_is_read_to_the_last_digit() {
    let positions = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
    let water = read(WATER);
    assert_positions(&water, &[[0.0, 0.0, 0.25], [0.5, 0.75, -0.5], [0.0, -0.75, -0.5]]);
    assert_eq!(names(&water), ["O", "H", "H"]);
    assert_positions(&read(DUMP), &[[1.0, 2.0, 3.0], [4.0, 6.0, 8.0]]);
    let protein = read(PDB);
    assert_positions(&protein, &[[1.0, 2.0, 3.0], [5.0, 6.5, 7.0], [-1.0, 0.0, 2.5]]);
    assert_eq!(names(&protein), ["C", "CA", "H"]);
    assert_positions(&read(CIF), &[[1.0, 2.0, 3.0], [1.5, 2.0, 3.0]]);
    let table = read(TABLE);
    assert_positions(&table, &positions);
    assert_eq!((radii(&table), colors(&table)), (vec![0.5, 0.25], vec![[1.0, 0.0, 0.0], bytes([0, 51, 0])]));
    let points = read(PLY);
    assert_positions(&points, &positions);
    assert_eq!((radii(&points), colors(&points)), (vec![0.5, 0.25], vec![[1.0, 0.0, 0.0], bytes([0, 0, 51])]));
    // Ends of lines do not matter.
    for text in [WATER, DUMP, PDB, CIF, TABLE, PLY] {
        assert_eq!(read(text.replace('\n', "\r\n")), read(text));
    }
    assert_eq!(scene("a", WATER.as_bytes(), &Options::default()).unwrap(), water);
    assert!(scene("a", b"NEAR 1", &Options::default()).unwrap_err().to_string().contains("no format"));
}

#[test]
fn coordinates_may_be_anywhere_in_a_row() {
    let box_of = |bounds: &str, columns: &str, row: &str| {
        let text = format!(
            "ITEM: UNITS\nmetal\nITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS {bounds}\nITEM: ATOMS {columns}\n{row}\n"
        );
        let scene = read(&text);
        (scene.spheres[1].center - scene.spheres[0].center).to_array()
    };
    let plain = "pp pp pp\n-1 3\n0 10\n5 6";
    assert_eq!(box_of(plain, "z q y x", "0 9 0 0\n3 9 2 1"), [1.0, 2.0, 3.0]);
    assert_eq!(box_of(plain, "id xu yu zu", "1 0 0 0\n2 1 2 3"), [1.0, 2.0, 3.0]);
    assert_eq!(box_of(plain, "xs ys zs", "0 0 0\n0.5 0.5 0.5"), [2.0, 5.0, 0.5]);
    // The bounds of a tilted box enclose it: xy = 2, xz = −1, yz = 4; lengths 4, 10, 8.
    let tilted = "xy xz yz pp pp pp\n-1 6 2\n0 14 -1\n0 8 4";
    assert_eq!(box_of(tilted, "xs ys zs", "0 0 0\n1 1 1"), [4.0 + 2.0 - 1.0, 10.0 + 4.0, 8.0]);
    assert_eq!(box_of(tilted, "xsu ysu zsu", "0 0 0\n1 0 0"), [4.0, 0.0, 0.0]);
    let general = "abc origin pp pp pp\n1 2 3 7\n0 4 0 7\n0 0 5 7";
    assert_eq!(box_of(general, "xs ys zs", "0 0 0\n1 1 0"), [1.0, 6.0, 3.0]);
    let extended = "2\nLattice=\"9 0 0 0 9 0 0 0 9\" Properties=id:I:1:pos:R:3:species:S:1:radius:R:1\n1 0 0 0 Fe 2\n2 1 2 3 O 3\n";
    let scene = read(extended);
    assert_positions(&scene, &[[0.0; 3], [1.0, 2.0, 3.0]]);
    assert_eq!((names(&scene), radii(&scene)), (vec!["Fe", "O"], vec![2.0, 3.0]));
}

#[test]
fn binary_points_are_those_of_the_text() {
    let header = PLY.replace("element camera 1\nproperty float f\n", "element camera 1\nproperty list uchar short f\n");
    let header = header.split_inclusive("end_header\n").next().unwrap();
    for (name, big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let mut file = header.replace("ascii", name).into_bytes();
        let mut put = |mut bytes: Vec<u8>| {
            if big {
                bytes.reverse();
            }
            file.extend(bytes);
        };
        put(vec![2]);
        for number in [1_i16, -2] {
            put(number.to_le_bytes().into());
        }
        for (position, color, radius) in
            [([1.0_f32, 2.0, 3.0], [255_u8, 0, 0], 0.5_f64), ([4.0, 5.0, 6.0], [0, 0, 51], 0.25)]
        {
            for number in position {
                put(number.to_le_bytes().into());
            }
            for level in color {
                put(vec![level]);
            }
            put(radius.to_le_bytes().into());
        }
        assert_eq!(read(&file), read(PLY), "{name}");
        let cut = fault_with(&file[..file.len() - 1], &Options::default());
        assert_eq!((&*cut.token, &*cut.message), ("end of file", "the file ends after 1 of 2 `vertex`"));
        let more = fault_with([&file[..], b"\0"].concat(), &Options::default());
        assert_eq!((&*more.token, &*more.message), ("more bytes", "the file goes on behind its last element"));
        let at = file.len() - 8;
        file[at..].fill(0xff);
        let fault = fault_with(&file, &Options::default());
        assert_eq!((&*fault.token, &*fault.message), ("vertex 2", "`NaN` is not a finite number"));
    }
}

#[test]
fn lists_of_impossible_lengths_are_refused() {
    let header = |length: &str| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement face 2\nproperty list {length} uchar corners\nelement vertex 1\n\
             property float x\nproperty float y\nproperty float z\nend_header\n"
        )
    };
    let end = "expected as many entries as it says";
    let whole = "expected a whole number from 0";
    for (length, bytes, token, message, expected) in [
        ("char", &[1, 9, 0xff][..], "face 2", "the list `corners` cannot have -1 entries", whole),
        ("float", &[0, 0, 0, 0x3f], "face 1", "the list `corners` cannot have 0.5 entries", whole),
        ("float", &[0, 0, 0xc0, 0x7f], "face 1", "the list `corners` cannot have NaN entries", whole),
        ("uint", &[0xff; 4], "end of file", "the file ends within a list `corners` of 4294967295", end),
    ] {
        // What follows is enough for the vertex.
        let text = [header(length).as_bytes(), bytes, &[0; 20]].concat();
        let fault = fault_with(&text, &Options::default());
        assert_eq!((&*fault.token, &*fault.message, &*fault.expected), (token, message, expected), "{length}");
    }
    let text = [header("uchar").as_bytes(), &[2, 7, 7, 0], &[0; 12]].concat();
    assert_positions(&read(text), &[[0.0; 3]]);
}

#[test]
fn columns_that_are_not_used_may_share_a_name() {
    for text in ["x,y,z,v,v\n1,2,3,4,5\n", "x,y,z,type,v,v\n1,2,3,1,4,5\n"] {
        assert_positions(&read(text), &[[1.0, 2.0, 3.0]]);
        let fault = fault_with(text, &by("v"));
        assert_eq!(
            (fault.line, &*fault.token, &*fault.message),
            (1, "v", "a second column `v`, and one of them is used")
        );
    }
    read(DUMP.replace(" id type x y z q", " q type x y z q"));
}

#[test]
fn real_files_are_read_whole() {
    let extent = |scene: &Scene| {
        let centers = || scene.spheres.iter().map(|sphere| sphere.center);
        let high = centers().reduce(DVec3::max).unwrap();
        (high - centers().reduce(DVec3::min).unwrap()).to_array().map(|length| (length * 1000.0).round() / 1000.0)
    };
    let count = |scene: &Scene, symbol| names(scene).iter().filter(|name| **name == symbol).count();
    // The numbers are those of gemmi: `tests/import/check.py`.
    let gramicidin = read(file("gramicidin.pdb"));
    assert_eq!(["C", "N", "O"].map(|symbol| count(&gramicidin, symbol)), [198, 40, 34]);
    let peptide = read(file("1yjp.cif"));
    assert_eq!((peptide.spheres.len(), count(&peptide, "O")), (66, 21));
    assert_eq!(extent(&peptide), [24.891, 5.321, 12.435]);
    for name in ["benzene.xyz", "argon.lammpstrj", "spiral.csv", "globe.ply"] {
        read(file(name));
    }
}

#[test]
fn malformed_xyz_is_refused_where_it_is_wrong() {
    assert_faults(&[
        ("3\nc\nO 0 0 0\nH 0 0 1\n", 4, 8, "end of file", "the file ends after 2 of 3 atoms"),
        ("1\n", 1, 2, "end of file", "ends before the comment"),
        ("1\nc\nO 0 zero 0\n", 3, 5, "zero", "`zero` is not a number"),
        ("1\nc\nO 0 inf 0\n", 3, 5, "inf", "`inf` is not a finite number"),
        ("1\nc\nO 0 nan 0\n", 3, 10, "end of line", "a frame without particles"),
        ("1\nc\nO 0 1e300 0\n", 3, 5, "1e300", "`1e300` is too large"),
        ("1\nc\nO 0 0\n", 3, 6, "end of line", "3 fields in a row of 4"),
        ("2\nc\nO 0 0 0 9\nO 0 0\n", 4, 6, "end of line", "3 fields in a row of 5"),
        ("0\nc\n", 2, 2, "end of line", "a frame without particles"),
        ("1\nProperties=pos:R\n0 0 0\n", 2, 12, "pos:R", "`pos:R` is no property"),
        ("1\nProperties=a:S:1:b:R:1\nO 1\n", 2, 1, "Properties=a:S:1:b:R:1", "no columns of coordinates among a, b"),
        ("1\nLattice=\"1 0 x\" \nO 0 0 0\n", 2, 14, "x", "`x` is not a number"),
        ("1\nc\nO 0 0 0\nO 1 0 0\n", 4, 1, "O 1 0 0", "`O 1 0 0` is no number of atoms"),
        (
            "1\nProperties=species:S:1:pos:R:3:pos:R:3\nO 0 0 0 1 1 1\n",
            2,
            32,
            "pos",
            "a second column `pos_1`, and one of them is used",
        ),
        ("2\nc\nC 0 0 1e17\nO 1 0 0\n", 4, 8, "end of line", "the particles of frame 1 reach too far"),
        ("1\nLattice=\"1 0 0\" \nO 0 0 0\n", 2, 10, "1 0 0", "a lattice of 3 numbers"),
        ("1\nProperties=species:S:1:pos:R:3\nO 0 0 0 1\n", 3, 10, "end of line", "5 fields in a row of 4"),
    ]);
    let second = fault_with("1\nc\nO 0 0 0\nO 0 0 0\n", &Options { frames: Frames::All, ..Options::default() });
    assert_eq!((second.line, &*second.message), (4, "`O 0 0 0` is no number of atoms"));
    // All errors are found in one run.
    let text = "2\nc\nO a 0 0\nO 0 b 0\n";
    assert_eq!(import(text, &Options::default())[0].parsed.errors, 2);
}

#[test]
fn malformed_dumps_are_refused_where_they_are_wrong() {
    let with = |from: &str, to: &str| {
        assert!(DUMP.contains(from));
        DUMP.replace(from, to)
    };
    let unboxed = with("ITEM: BOX BOUNDS pp pp pp\n0 10\n0 10\n0 10\n", "").replace(" x y z", " xs ys zs");
    let head = "ITEM: ATOMS id type fx fy fz q";
    assert_faults(&[
        (&DUMP[..DUMP.find("ITEM: ATOMS").unwrap()], 8, 5, "end of file", "ends before the atoms"),
        (&with("2 2 4 6 8 0.5\n", ""), 10, 15, "end of file", "after 1 of 2 atoms"),
        (&with("0 10\n0 10\n0 10", "0 10\n0 10\n10 0"), 8, 5, "end of line", "a box that has no size"),
        (&with("0 10\n0 10\n0 10", "-1e308 1e308\n0 1\n0 1"), 8, 4, "end of line", "beyond what a number can hold"),
        (&with("ATOMS\n2", "ATOMS\n1"), 11, 1, "2 2 4 6 8 0.5", "`2 2 4 6 8 0.5` is no item"),
        (&with("pp pp pp\n0 10", "pp pp pp\n0"), 6, 2, "end of line", "1 field in a bound"),
        (&with("0 10\n0 10\n0 10", "0 10\n0 ten\n0 10"), 7, 3, "ten", "`ten` is not a number"),
        (&with("ATOMS\n2\n", "ATOMS\n-2\n"), 4, 1, "-2", "`-2` is no number of atoms"),
        (&with("1 2 3 -0.5", "1 2 3"), 10, 10, "end of line", "5 fields in a row of 6"),
        (&with(" x y z", " fx fy fz"), 9, 1, head, "no columns of coordinates"),
        (&with("ITEM: NUMBER OF ATOMS\n2\n", ""), 7, 1, "ITEM: ATOMS id type x y z q", "atoms without their number"),
        (&with(" x y z q", " x y z x"), 9, 27, "x", "a second column `x`"),
        (&unboxed, 5, 1, "ITEM: ATOMS id type xs ys zs q", "fractions of a box without a box"),
    ]);
    let more = fault_with(with("ATOMS\n2", "ATOMS\n1"), &Options { frames: Frames::All, ..Options::default() });
    assert_eq!((more.line, &*more.message), (11, "`2 2 4 6 8 0.5` is no item"));
}

#[test]
fn structures_may_have_comments_in_loops_and_models_without_an_end() {
    let loops = "data_X\nloop_\n_atom_site.type_symbol\n# where\n_atom_site.Cartn_x\n\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n\
                 # chain A\nN 0 0 0\n# chain B\nC 1 1 1\n\nC 2 2 2\n#\nloop_\n_other.id\n1\n";
    assert_eq!(names(&read(loops)), ["N", "C", "C"]);
    let atom = "ATOM      1  N   ALA A   1      11.104   6.134  -6.504  1.00  0.00           N  \n";
    let models = format!("MODEL 1\n{atom}MODEL 2\n{atom}{atom}");
    let frames = import(models, &Options { frames: Frames::All, ..Options::default() });
    let spheres: Vec<_> = frames.iter().map(|frame| frame.parsed.scene.as_ref().unwrap().spheres.len()).collect();
    assert_eq!(spheres, [1, 2]);
}

#[test]
fn malformed_structures_are_refused_where_they_are_wrong() {
    assert_faults(&[
        (&PDB.replace("   6.500", "   6.5x0"), 3, 42, "6.5x0", "`6.5x0` is not a number"),
        (&PDB[..60], 2, 46, "end of line", "an atom's record of 45 columns"),
        ("HEADER    NOTHING\nEND\n", 2, 4, "end of file", "ends before its first frame"),
        (&CIF.replace("1.5 2 3 'a b' 1", "1.5 2 ? x 1"), 16, 11, "?", "`?` is not a number"),
        (&CIF.replace("'a b' 1", "'a b'"), 16, 18, "end of line", "6 values in a row of 7"),
        ("data_X\n_atom_site.id 1\n", 2, 1, "_atom_site.id 1", "_atom_site is no loop"),
        ("data_X\nloop_\n_atom_site.id\n#\n", 4, 2, "end of line", "no row of _atom_site"),
        ("data_X\n_cell.a 1\n", 2, 10, "end of file", "ends before its first frame"),
    ]);
}

#[test]
fn malformed_tables_and_points_are_refused_where_they_are_wrong() {
    assert_faults(&[
        ("x,y\n1,2\n", 1, 1, "x,y", "no columns of coordinates among x, y"),
        ("x,y,2024\n1,2,3\n", 1, 1, "x,y,2024", "no columns of coordinates"),
        ("1 2 3\n1 2\n", 2, 4, "end of line", "2 fields in a row of 3"),
        ("5\n1 2 3\n4 5 6\n", 3, 6, "end of file", "the file ends after 2 of 5 points"),
        ("2\n1 2 3\n\n# last\n4 5 6\n7 8 9\n", 6, 1, "7 8 9", "the file goes on behind 2 points"),
        ("0\n1 2 3\n", 2, 1, "1 2 3", "the file goes on behind 0 points"),
        ("1 2 3 0 255 0\n1 2 3 0 256 0\n", 2, 9, "256", "`256` is no part of a colour"),
        ("x,y,z\n1,2\n", 2, 4, "end of line", "2 fields in a row of 3"),
        ("x,y,z\n1,2,3,4\n", 2, 8, "end of line", "4 fields in a row of 3"),
        ("x,y,z\n", 1, 6, "end of line", "a table without rows"),
        ("x,y,mass\n1,2,3\n", 1, 1, "x,y,mass", "no columns of coordinates among x, y, mass"),
        ("x,y,z,x\n1,2,3,4\n", 1, 7, "x", "a second column `x`"),
        ("\"x\",\"y\",\"z\",\"y\"\n1,2,3,4\n", 1, 14, "y", "a second column `y`"),
        ("x,y,z,radius,radius\n1,2,3,1,1\n", 1, 14, "radius", "a second column `radius`"),
        ("x,y,z,r,g,b,type,g\n1,2,3,1,1,1,1,1\n", 1, 18, "g", "a second column `g`"),
        ("x,y,z,radius\n1,2,3,0\n", 2, 7, "0", "a radius cannot be 0"),
        ("x,y,z,r,g,b\n1,2,3,0,256,0\n", 2, 9, "256", "`256` is no part of a colour"),
        ("x,y,z,color\n1,2,3,#12345\n", 2, 7, "#12345", "`#12345` is no colour"),
        (&PLY.replace("vertex 2", "vertex many"), 6, 1, "element vertex many", "is not understood"),
        (&PLY.replace("vertex 2", "vertex 3"), 17, 18, "end of file", "ends after 2 of 3 `vertex`"),
        (&PLY.replace("float y", "list uchar int foo"), 8, 25, "foo", "`foo` of vertices is a list"),
        (&PLY.replace("ascii", "ebcdic"), 2, 1, "format ebcdic 1.0", "is not understood"),
        (&PLY.replace("4 5 6 0", "4 5 6"), 17, 16, "end of line", "6 fields in a row of 7"),
        (&format!("{PLY}7 8 9 0 0 0 1\n"), 18, 1, "7 8 9 0 0 0 1", "goes on behind its last element"),
        (&PLY.replace("end_header", &format!("{FACE}end_header")), 19, 18, "end of file", "ends after 0 of 1 `face`"),
        (&PLY.replace("double radius", "double x"), 14, 1, "end_header", "a second column `x`"),
        ("data_X\nloop_\n_atom_site_label\n_atom_site_fract_x\n", 4, 1, "_atom_site_fract_x", "fractional coordinates"),
        ("ply\nformat ascii 1.0\nend_header\n", 3, 11, "end of line", "no element `vertex`"),
    ]);
}

#[test]
fn an_unknown_column_is_answered_with_those_that_there_are() {
    let missing = fault_with(DUMP, &by("speed:magma"));
    assert_eq!((missing.line, missing.column), (9, 1));
    assert_eq!(missing.message, "there is no column `speed`, which --color-by names");
    assert_eq!(missing.expected, "the columns are id, type, x, y, z, q");
    let radius = Options { radius: Radius::Column("size".into()), ..Options::default() };
    assert!(fault_with(PDB, &radius).expected.contains("occupancy, bfactor"));
    assert!(fault_with(DUMP, &by("element")).message.contains("no column of elements, which --color-by element needs"));
    let covalent = Options { radius: Radius::Covalent, ..Options::default() };
    assert!(fault_with(TABLE, &covalent).message.contains("--radius covalent needs"));
}

#[test]
fn unknown_elements_and_records_are_warned_of() {
    let imported = &import("3\nc\nC 0 0 0\nQq 2 0 0\nQq 4 0 0\n", &Options::default())[0];
    let [warning] = &imported.parsed.diagnostics[..] else { panic!("{}", imported.parsed.report(false)) };
    assert_eq!((warning.severity, warning.line, warning.column, &*warning.token), (Severity::Warning, 4, 1, "Qq"));
    assert!(imported.notes[0].starts_with("no radius for 2 particles: half their mean distance is taken, 0.6667 "));
    assert_eq!(radii(imported.parsed.scene.as_ref().unwrap())[0], 1.7);
    let imported = &import(PDB.replace("END\n", "ENC\n"), &Options::default())[0];
    assert_eq!(imported.parsed.diagnostics[0].message, "`ENC` is no record of a PDB file");
    assert!(imported.parsed.scene.is_some());
}

#[test]
fn columns_without_names_are_numbered() {
    let plain = read("x,y,z,r,g,b\n1,2,3,255,0,0\n4,5,6,0,255,0\n");
    for text in [
        ",x,y,z,r,g,b\n0,1,2,3,255,0,0\n1,4,5,6,0,255,0\n",
        "\"\",\"x\",\"y\",\"z\",\"r\",\"g\",\"b\"\n\"1\",1,2,3,255,0,0\n\"2\",4,5,6,0,255,0\n",
        "x,y,z,r,g,b,\n1,2,3,255,0,0,\n4,5,6,0,255,0,\n",
    ] {
        assert_eq!(read(text), plain, "{text}");
    }
    assert_eq!(fault_with(",x,y,z\n0,1,2,3\n", &by("q")).expected, "the columns are column_1, x, y, z");
}

#[test]
fn points_need_no_names() {
    let plain = read("x,y,z,r,g,b\n1,2,3,255,0,0\n4,5.5,6,0,255,0\n");
    for text in [
        "1 2 3 255 0 0\n4 5.5 6 0 255 0\n",
        "1;2;3;255;0;0\n4;5.5;6;0;255;0\n",
        "1\t2\t3\t255\t0\t0\n4\t5.5\t6\t0\t255\t0\n",
        "//X Y Z R G B\n1 2 3 255 0 0\n4 5.5 6 0 255 0\n",
        "# r, g, b, x, y, z\n255 0 0 1 2 3\n0 255 0 4 5.5 6\n",
        "1 2 3 255 0 0 7\n4 5.5 6 0 255 0 8\n",
        "2\n1 2 3 7 255 0 0\n4 5.5 6 8 0 255 0\n",
        "2\n1.0 2 3 255 0 0\n4 5.5 6 0 255 0\n",
        "2\nComment\n1.0 2 3 255 0 0\n4 5.5 6 0 255 0\n",
    ] {
        assert_eq!(read(text), plain, "{text}");
    }
    assert_positions(&read("# made by hand\n1, 2, 3\n4, 5, 6\n"), &[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    let intensity = Options { radius: Radius::Column("intensity".into()), ..Options::default() };
    assert_eq!(radii(&read_with("1 2 3 0.5\n4 5 6 0.25\n", &intensity)), [0.5, 0.25]);
    // Normals are no colours.
    assert_eq!(colors(&read("1 2 3 0 0 -1\n")), colors(&read("1 2 3\n")));
}

#[test]
fn rows_without_coordinates_are_left_out_and_without_colours_grey() {
    for (text, token) in [
        ("x,y,z\n1,2,3\n1,,3\n4,5,6\n", "end of line"),
        ("x,y,z\n1,2,3\n1,NaN,3\n4,5,6\n", "NaN"),
        ("x,y,z\n1,2,3\n1,NA,3\n4,5,6\n", "NA"),
        ("# points\n1 2 3\n1 nan 3\n4 5 6\n", "nan"),
    ] {
        let parsed = &import(text, &Options::default())[0].parsed;
        let [warning] = &parsed.diagnostics[..] else { panic!("{text}: {}", parsed.report(false)) };
        assert_eq!((warning.severity, warning.line, &*warning.message), (Severity::Warning, 3, "`y` is missing"));
        assert!(warning.token == token || token == "end of line", "{}", warning.token);
        assert_positions(parsed.scene.as_ref().unwrap(), &[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    }
    let grey = bytes([128; 3]);
    let many = format!("x,y,z\n1,2,3\n{}", "nan,0,0\n".repeat(30));
    let parsed = &import(many, &Options::default())[0].parsed;
    assert!(
        parsed.report(false).contains("10 more warnings about rows without coordinates"),
        "{}",
        parsed.report(false)
    );
    for (text, options, expected) in [
        ("x,y,z,r,g,b\n1,2,3,,,\n4,5,6,0,255,0\n", Options::default(), [grey, [0.0, 1.0, 0.0]]),
        ("x,y,z,color\n1,2,3,\n4,5,6,#00ff00\n", Options::default(), [grey, [0.0, 1.0, 0.0]]),
        ("x,y,z,v\n1,2,3,\n4,5,6,7\n", by("v:gray:6..7"), [grey, [1.0; 3]]),
        ("x,y,z,v\n1,2,3,nan\n4,5,6,nan\n", by("v"), [grey, grey]),
        ("x,y,z,v\n1,2,3,\n4,5,6,Na\n", by("v"), [grey, Map::Categories.colors()[0].to_array()]),
    ] {
        let parsed = &import(text, &options)[0].parsed;
        assert_eq!((parsed.errors, &*parsed.diagnostics[0].help.clone().unwrap()), (0, "the particle is grey"));
        assert_eq!(colors(parsed.scene.as_ref().unwrap()), expected, "{text}");
    }
}

/// The symbols that are guessed for atoms of a name in its four columns and a residue.
#[test]
fn elements_are_guessed_from_names_of_atoms() {
    let cases = [
        (" CA ", "ALA", "C"),
        ("CA  ", "ALA", "C"),
        (" CD1", "LEU", "C"),
        ("HG11", "VAL", "H"),
        (" HG ", "SER", "H"),
        (" NE2", "HID", "N"),
        ("1HB ", "ALA", "H"),
        (" OH2", "TIP3", "O"),
        (" CA ", "CA", "CA"),
        (" NA ", "NA+", "NA"),
        (" NA ", "NA", "NA"),
        ("CL- ", "CL-", "CL"),
        (" CL ", "CL", "CL"),
        (" K  ", "K", "K"),
        ("SOD ", "SOD", "NA"),
        ("CLA ", "CLA", "CL"),
        ("POT ", "POT", "K"),
        ("CES ", "CES", "CS"),
        ("CAL ", "CAL", "CA"),
        ("CD2 ", "CD2", "CD"),
        (" FE ", "HEM", "FE"),
        (" NA ", "HEM", "N"),
        (" CL1", "LIG", "CL"),
        (" BR ", "LIG", "BR"),
        ("ZN  ", "LIG", "ZN"),
        (" C1 ", "LIG", "C"),
        (" C1'", "C", "C"),
    ];
    for (name, residue, expected) in cases {
        let text = format!("ATOM      1 {name} {residue:<4}A   1       1.000   2.000   3.000\n");
        let imported = &import(&text, &Options::default())[0];
        assert_eq!(names(imported.parsed.scene.as_ref().unwrap()), [expected], "{name} {residue}: {text}");
        assert_eq!(imported.notes, ["warning: the elements of 1 particle are guessed from names of atoms"]);
    }
    let imported = &import("4\nc\nOH2 0 0 0\nHW1 1 0 0\nCl1 2 0 0\nOH2 3 0 0\n", &Options::default())[0];
    assert_eq!(imported.notes, ["warning: the elements of 3 particles are guessed from names of atoms"]);
    assert_eq!(radii(imported.parsed.scene.as_ref().unwrap()), [1.52, 1.2, 1.75, 1.52]);
}

#[test]
fn numbers_before_coordinates_are_types_or_elements() {
    let types = &import("3\nAtoms. Timestep: 0\n1 0 0 0\n3 1 0 0\n1 2 0 0\n", &Options::default())[0];
    let plain = &import("2\n\n1 0 0 0\n2 1 0 0\n", &Options::default())[0];
    let categories = Map::Categories.colors();
    for imported in [types, plain] {
        assert!(imported.notes.iter().any(|note| note.contains("taken for types")), "{:?}", imported.notes);
        assert!(imported.notes.iter().any(|note| note.contains("half their mean distance")));
        let found = colors(imported.parsed.scene.as_ref().unwrap());
        assert_eq!(found[..2], [categories[0].to_array(), categories[1].to_array()]);
    }
    let water = &import(WATER.replace('O', "8").replace("H ", "1 "), &Options::default())[0];
    assert_eq!(water.notes, ["the numbers before the coordinates are taken for atomic numbers"]);
    assert_eq!(radii(water.parsed.scene.as_ref().unwrap()), [1.52, 1.2, 1.2]);
}

#[test]
fn frames_without_particles_are_left_out() {
    let empty = DUMP.replace("ATOMS\n2", "ATOMS\n0").replace("1 1 1 2 3 -0.5\n2 2 4 6 8 0.5\n", "");
    let text = [DUMP, &empty, DUMP].concat();
    let all = Options { frames: Frames::All, ..Options::default() };
    let found = import(&text, &all);
    let kept = found.iter().map(|frame| (frame.number, frame.parsed.scene.is_some(), frame.parsed.errors));
    assert_eq!(kept.collect::<Vec<_>>(), [(1, true, 0), (2, false, 0), (3, true, 0)]);
    assert_eq!(found[1].parsed.diagnostics[0].help.as_deref(), Some("frame 2 is left out"));
    assert_eq!(fault_with(&empty, &Options::default()).message, "a frame without particles");
}

/// What leaves the picture of the first frame is said.
#[test]
fn particles_beside_the_picture_are_warned_of() {
    let text = "2\nc\nHe -9 0 0\nHe 9 0 0\n2\nc\nHe -9 0 0\nHe 12 0 0\n2\nc\nHe -9 0 0\nHe 9 0 0\n";
    let found = import(text, &Options { frames: Frames::All, ..Options::default() });
    let notes: Vec<_> = found.iter().map(|frame| frame.notes.clone()).collect();
    assert!(notes[0].is_empty() && notes[2].is_empty(), "{notes:?}");
    assert_eq!(notes[1], ["warning: 1 particle is not whole in the picture, which fits the first frame"]);
}

#[test]
fn frames_are_read_one_by_one() {
    let frames = |text: &str| Options { frames: text.parse().unwrap(), ..Options::default() };
    let numbers = |text: &[u8], chosen: &str| {
        let found = import(text, &frames(chosen));
        found.iter().map(|frame| frame.parsed.scene.as_ref().map(|_| frame.number)).collect::<Vec<_>>()
    };
    let argon = file("argon.lammpstrj");
    assert_eq!(numbers(&argon, "all"), [Some(1), Some(2), Some(3)]);
    assert_eq!(numbers(&argon, "last"), [Some(3)]);
    assert_eq!(numbers(&argon, "1,3"), [Some(1), Some(3)]);
    assert_eq!(numbers(&argon, "2-3"), [Some(2), Some(3)]);
    assert_eq!(numbers(&argon, "3-4"), [Some(3), None]);
    assert_eq!(fault_with(&argon, &frames("7")).message, "there is no frame 7: the file has 3");
    assert_eq!(fault_with(WATER, &frames("2")).message, "there is no frame 2: the file has one");
    for text in [&file("benzene.xyz"), CIF.as_bytes(), PDB.replace("END\n", &format!("ENDMDL\n{PDB}")).as_bytes()] {
        assert_eq!(numbers(text, "all"), [Some(1), Some(2)]);
        assert_eq!(numbers(text, "2"), [Some(2)]);
    }
    assert_positions(&read_with(CIF, &frames("last")), &[[4.0, 5.0, 6.0], [4.0, 5.0, 8.0]]);
    assert_eq!(read_with(&argon, &frames("last")), read_with(&argon, &frames("3")));
    // The camera of the first stays.
    let both: Vec<_> = import(CIF, &frames("all")).into_iter().map(|frame| frame.parsed.scene.unwrap()).collect();
    assert_eq!(both[0].window, both[1].window);
    assert_eq!((both[1].spheres[0].center - both[0].spheres[0].center).to_array(), [3.0, 3.0, 3.0]);
    for wrong in ["0", "", "3-2", "1,,2", "first", "-1"] {
        assert!(wrong.parse::<Frames>().is_err(), "{wrong}");
    }
}

/// What is after the last chosen frame is not read.
#[test]
fn no_more_is_read_than_asked_for() {
    struct Endless(Vec<u8>, usize);
    impl std::io::Read for Endless {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            self.1 += buffer.len();
            assert!(self.1 < 8 << 20, "a second frame is read");
            for (at, byte) in buffer.iter_mut().enumerate() {
                *byte = self.0[at % self.0.len()];
            }
            Ok(buffer.len() / self.0.len() * self.0.len())
        }
    }
    let options = Options { frames: "2".parse().unwrap(), ..Options::default() };
    let mut frames = Import::new("endless", Format::Xyz, Endless(WATER.into(), 0), options);
    assert_eq!(frames.next().unwrap().parsed.scene.unwrap().spheres.len(), 3);
    assert!(frames.next().is_none());
}

#[test]
fn radii_come_from_where_they_are_asked_for() {
    let with = |radius: &str, text: &str| {
        radii(&read_with(text, &Options { radius: radius.parse().unwrap(), ..Options::default() }))
    };
    assert_eq!(radii(&read(WATER)), [1.52, 1.2, 1.2]);
    assert_eq!(with("element", WATER), [1.52, 1.2, 1.2]);
    assert_eq!(with("covalent", WATER), [0.66, 0.31, 0.31]);
    assert_eq!(with("0.5", WATER), [0.5; 3]);
    assert_eq!(with("speed", TABLE), [1.5, 2.5]);
    assert_eq!(with("SPEED", TABLE), [1.5, 2.5]);
    assert_eq!(radii(&read(TABLE.replace("radius", "diameter"))), [0.25, 0.125]);
    // Two particles in a box of 3 × 4 × 5.
    let half = (60.0_f64 / 2.0).cbrt() / 2.0;
    assert!(radii(&read(DUMP)).iter().all(|radius| (radius - half).abs() < 1e-12));
    let scaled = Options { radius_scale: 0.5, ..Options::default() };
    assert_eq!(radii(&read_with(WATER, &scaled)), [0.76, 0.6, 0.6]);
    for wrong in ["0", "-1", "nan", "inf", ""] {
        assert!(wrong.parse::<Radius>().is_err(), "{wrong}");
    }
}

#[test]
fn colors_come_from_where_they_are_asked_for() {
    let with = |source: &str, text: &str| colors(&read_with(text, &by(source)));
    assert_eq!(colors(&read(WATER)), [bytes([255, 13, 13]), [1.0; 3], [1.0; 3]]);
    assert_eq!(with("0.5,0,1", WATER), [[0.5, 0.0, 1.0]; 3]);
    assert_eq!(with("#ff8000", WATER), [bytes([255, 128, 0]); 3]);
    assert_eq!(with("element", WATER), colors(&read(WATER)));
    // The ends of maps, as their authors have them.
    let ends = [
        ("viridis", [68, 1, 84], [253, 231, 37]),
        ("magma", [0, 0, 4], [252, 253, 191]),
        ("inferno", [0, 0, 4], [252, 255, 164]),
        ("plasma", [13, 8, 135], [240, 249, 33]),
        ("cividis", [0, 34, 78], [254, 232, 56]),
        ("coolwarm", [59, 76, 192], [180, 4, 38]),
        ("gray", [0, 0, 0], [255, 255, 255]),
    ];
    for (map, low, high) in ends {
        assert_eq!(with(&format!("q:{map}"), DUMP), [low, high].map(bytes), "{map}");
        assert_eq!(with(&format!("q:{map}:0.5..-0.5"), DUMP), [high, low].map(bytes), "{map}");
    }
    assert_eq!(Map::ALL.map(|map| map.colors().len()), [256, 256, 256, 256, 256, 256, 2, 7]);
    assert_eq!(with("q", DUMP), with("q:viridis", DUMP));
    assert_eq!(with("q:gray:-1.5..2.5", DUMP), [[0.25; 3], [0.5; 3]]);
    assert_eq!(with("q:gray:0..0.1", DUMP), [[0.0; 3], [1.0; 3]]);
    // Types and words are categories, numbers where that is asked for.
    let categories = Map::Categories.colors();
    let first = [categories[0].to_array(), categories[1].to_array()];
    assert_eq!(colors(&read(DUMP)), first);
    assert_eq!(with("q:categories", DUMP), first);
    assert_eq!(with("name", TABLE), first);
    assert_eq!(with("chain", PDB), [first[0], first[0], first[1]]);
    assert_eq!(fault_with(TABLE, &by("name:viridis")).message, "`a` is not a number");
    assert_eq!(colors(&read("x,y,z,color\n1,2,3,#ff0000\n")), [[1.0, 0.0, 0.0]]);
    assert_eq!(colors(&read("x,y,z,r,g,b\n1,2,3,1,0.5,0\n")), [[1.0, 0.5, 0.0]]);
    assert!("255,128,0".parse::<Coloring>().unwrap_err().contains("0 to 1; this may be meant: #ff8000"));
    for wrong in ["", "255,128,0", "-1,0,0", ":viridis", "q:viridis:1..1", "q:a..b", "q:categories:0..1"] {
        assert!(wrong.parse::<Coloring>().is_err(), "{wrong}");
    }
}

#[test]
fn the_camera_sees_all_and_no_more() {
    let scenes = [WATER, DUMP, PDB, TABLE, "1\nc\nFe 1e6 -1e6 3\n", "2\nc\nFe 0 0 0\nFe 0 0 -1000\n"];
    let directions = ["-z", "x", "-y", "1,2,-3"];
    for (text, direction) in scenes.iter().flat_map(|text| directions.map(|direction| (text, direction))) {
        for size in [(40, 30), (30, 90)] {
            let direction = trueray::import::direction(direction).unwrap();
            let scene = read_with(text, &Options { direction, size, ..Options::default() });
            let window = scene.window;
            assert_eq!((window.left, window.bottom), (-window.right, -window.top));
            let aspect = window.right / window.top * f64::from(size.1) / f64::from(size.0);
            assert!((aspect - 1.0).abs() < 1e-12, "pixels are squares");
            // How far, as a part of the window's half, the outline of a sphere reaches to either side: the tangent plane through the eye.
            let reach = |axis: usize, side: f64, half: f64| {
                let reach = scene.spheres.iter().map(|sphere| {
                    let (across, away) = (side * sphere.center[axis], -sphere.center.z);
                    let to = across.atan2(away) + (sphere.scale.x / across.hypot(away)).asin();
                    to.tan() * window.near / half
                });
                reach.fold(f64::NEG_INFINITY, f64::max)
            };
            let [right, left] = [1.0, -1.0].map(|side| reach(0, side, window.right));
            let [top, bottom] = [1.0, -1.0].map(|side| reach(1, side, window.top));
            let greatest = right.max(left).max(top).max(bottom);
            assert!((greatest - 0.96).abs() < 1e-6, "{text} {direction}: {right} {left} {top} {bottom}");
            let is_between = |a: f64, b: f64| (a - b).abs() < 1e-6;
            let touches = (is_between(right, 0.96) && is_between(left, 0.96))
                || (is_between(top, 0.96) && is_between(bottom, 0.96));
            assert!(touches, "{text} {direction}: {right} {left} {top} {bottom}");
            let nearest =
                scene.spheres.iter().map(|sphere| -sphere.center.z - sphere.scale.x).fold(f64::INFINITY, f64::min);
            assert!(window.near < nearest, "the image plane cuts nothing");
        }
    }
}

#[test]
fn views_are_along_directions_of_the_file() {
    let axes = |direction: &str, vertical: Option<&str>| {
        let direction = trueray::import::direction(direction).unwrap();
        let vertical = vertical.map(|vertical| trueray::import::direction(vertical).unwrap());
        Options { direction, vertical, ..Options::default() }.axes().map(|axes| axes.map(|axis| axis.to_array()))
    };
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis.to_array());
    assert_eq!(axes("-z", None), Ok([x, y, z]));
    assert_eq!(axes("0,0,-7", Some("y")), Ok([x, y, z]));
    assert_eq!(axes("y", None), Ok([x, z, [0.0, -1.0, 0.0]]));
    assert_eq!(axes("-x", Some("z")), Ok([y, z, x]));
    assert!(axes("x", Some("-x")).is_err());
    let turned = Options { direction: DVec3::NEG_X, vertical: Some(DVec3::Z), ..Options::default() };
    let scene = read_with(DUMP, &turned);
    assert_eq!((scene.spheres[1].center - scene.spheres[0].center).to_array(), [4.0, 5.0, 3.0]);
    for wrong in ["", "w", "--x", "xx", "1,2", "0,0,0", "1,nan,0"] {
        assert!(trueray::import::direction(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn intensities_sum_to_one() {
    for (lighting, lamps) in [("headlight", 1), ("three", 3), ("dome:1", 1), ("dome:7", 7), ("dome:64", 64)] {
        let scene = read_with(WATER, &Options { lighting: lighting.parse().unwrap(), ..Options::default() });
        assert_eq!(scene.lights.len(), lamps, "{lighting}");
        let sum: DVec3 = scene.lights.iter().map(|light| light.intensity).sum();
        assert!((sum - DVec3::ONE).abs().max_element() < 1e-12, "{lighting}: {sum}");
    }
    for wrong in ["", "dome", "dome:0", "dome:5000", "sun"] {
        assert!(wrong.parse::<Lighting>().is_err(), "{wrong}");
    }
}

/// The ball around all spheres is in the picture from all sides, and fills it.
#[test]
fn a_ball_is_seen_whole_from_all_sides() {
    for size in [(40, 30), (30, 90)] {
        let scene = read_with(PDB, &Options { framing: Framing::Ball, size, ..Options::default() });
        let (low, high) = scene.spheres.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), sphere| {
            (low.min(sphere.center - sphere.scale), high.max(sphere.center + sphere.scale))
        });
        let middle = low.midpoint(high);
        assert!(middle.truncate().length() < 1e-9, "the eye looks at the middle: {middle}");
        let reach = scene.spheres.iter().map(|sphere| (sphere.center - middle).length() + sphere.scale.x);
        let sine = reach.fold(0.0, f64::max) / -middle.z;
        let shorter = scene.window.top.min(scene.window.right) / scene.window.near;
        assert!((sine.asin().tan() / shorter - 0.96).abs() < 1e-6, "{size:?}");
    }
}

/// Seen from anywhere, lights are where they are for the first eye: to its left, above, or at itself.
#[test]
fn lights_turn_with_the_eye() {
    for lighting in ["headlight", "three", "dome:5"] {
        let options = Options { lighting: lighting.parse().unwrap(), framing: Framing::Ball, ..Options::default() };
        let usual = import(WATER, &options).remove(0);
        let (scene, lamps) = (usual.parsed.scene.unwrap(), usual.lamps.unwrap());
        let (low, high) = scene.spheres.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), sphere| {
            (low.min(sphere.center - sphere.scale), high.max(sphere.center + sphere.scale))
        });
        let middle = low.midpoint(high);
        let eye = middle + DVec3::new(middle.length(), 0.0, 0.0);
        let view = View::new(eye, Some(middle), DVec3::Y).unwrap();
        let [right, up, back] = view.axes();
        for (first, light) in scene.lights.iter().zip(lamps.seen_by(&view)) {
            let seen = light.position - eye;
            let seen = DVec3::new(right.dot(seen), up.dot(seen), back.dot(seen));
            assert!((seen - first.position).length() < 1e-9 * high.length(), "{lighting}: {seen}");
        }
        assert_eq!(lamps.seen_by(&View::FILE), scene.lights);
        let turned = read_with(WATER, &Options { view, ..options });
        assert_eq!(turned.lights, lamps.seen_by(&view));
    }
}

/// What a surface that faces the zenith gets of a dome of infinitely many lamps is 2/3: the mean cosine of directions that are as
/// dense as their cosine. Few lamps come near to it, from all sides alike.
#[test]
fn lamps_of_a_dome_are_evenly_spread() {
    let scene = read_with(WATER, &Options { lighting: Lighting::Dome(64), ..Options::default() });
    let (low, high) = scene.spheres.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), sphere| {
        (low.min(sphere.center - sphere.scale), high.max(sphere.center + sphere.scale))
    });
    let directions = scene.lights.iter().map(|light| (light.position - (low + high) / 2.0).normalize());
    let mean = directions.sum::<DVec3>() / 64.0;
    assert!((mean.length() - 2.0 / 3.0).abs() < 0.002, "{mean}");
    assert!(mean.normalize().dot(DVec3::new(-0.35, 0.6, 0.72).normalize()) > 0.9999, "{mean}");
}

fn run(folder: &std::path::Path, arguments: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
    command.args(arguments.split_whitespace()).current_dir(folder).stdin(Stdio::null()).output().unwrap()
}

#[track_caller]
fn assert_exit(output: &Output, code: i32, message: &str) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    assert!(stderr.contains(message) && !stderr.contains("panicked"), "expected '{message}' in:\n{stderr}");
}

/// One command from a file to a picture; the scene that `import` writes gives the same.
#[test]
fn particles_are_rendered_as_imported() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    std::fs::write(place.join("benzene.xyz"), file("benzene.xyz")).unwrap();
    let options = "--radius covalent --light headlight --frame 2 --color-by charge:coolwarm --res 40x30";
    assert_exit(&run(place, &format!("render --device cpu {options} benzene.xyz -o a.ppm")), 0, "a.ppm: 40 × 30");
    assert_exit(&run(place, &format!("import {options} benzene.xyz -o benzene.txt")), 0, "frame 2, 12 spheres");
    assert_exit(&run(place, "render --device cpu -q benzene.txt -o b.ppm"), 0, "");
    let read = |name: &str| std::fs::read(place.join(name)).unwrap();
    assert!(read("a.ppm") == read("b.ppm"));
    assert!(read("benzene.txt").starts_with(b"# frame 2 of benzene.xyz\nNEAR "));
    assert_exit(&run(place, &format!("check {options} benzene.xyz")), 0, "");
    assert_exit(&run(place, &format!("export {options} benzene.xyz --to tachyon -o benzene.dat")), 0, "");
    // Scenes have none of this.
    assert_exit(&run(place, "render --device cpu --radius 2 benzene.txt -o c.ppm"), 2, "holds no particles");
    assert_exit(&run(place, "import benzene.txt"), 3, "holds no particles");
    assert_exit(&run(place, "check --color-by 255,128,0 benzene.xyz"), 2, "#ff8000");
    assert_exit(&run(place, "check --color-by charge:-1e308..1e308 benzene.xyz"), 2, "no wider than 1.79");
    assert_exit(&run(place, "check --color-by charge:1..1 benzene.xyz"), 2, "two different numbers");
    assert_exit(&run(place, "render --frame all benzene.xyz -o c.ppm"), 2, "one frame");
    assert_exit(&run(place, "check --direction x --vertical x benzene.xyz"), 2, "--vertical is parallel");
    std::fs::write(place.join("bad.xyz"), "1\nc\nO 0 0 o\n").unwrap();
    assert_exit(&run(place, "render bad.xyz -o c.ppm"), 3, "bad.xyz:3:7");
}

/// The commands in the message that refuses several frames.
#[test]
fn several_frames_are_rendered_by_the_commands_that_are_shown() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    let two = WATER.repeat(2) + "0\nempty\n";
    std::fs::write(place.join("water.xyz"), two).unwrap();
    std::fs::create_dir(place.join("folder")).unwrap();
    let refused = run(place, "render --frame all --res 24x16 water.xyz -o c.ppm");
    let message = String::from_utf8(refused.stderr).unwrap();
    let commands: Vec<_> = message.lines().filter_map(|line| line.trim().strip_prefix("trueray ")).collect();
    let [import, render] = commands[..] else { panic!("{message}") };
    let import = import.replace("FILE", "water.xyz").replace("FOLDER", "folder") + " --res 24x16 --light headlight";
    assert_exit(&run(place, &import), 0, "frame 3 is left out");
    let render = render.replace("FOLDER/*.txt", "folder/0001.txt folder/0002.txt").replace("FOLDER", "folder");
    assert_exit(&run(place, &format!("{render} --device cpu")), 0, "0002.ppm: 24 × 16");
    std::fs::write(place.join("nothing.xyz"), "0\nempty\n").unwrap();
    assert_exit(&run(place, "import --frame all nothing.xyz -o folder/n%d.txt"), 3, "no frame has particles");
}

#[test]
fn frames_become_numbered_scenes() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    let argon = file("argon.lammpstrj");
    std::fs::write(place.join("argon 1"), &argon).unwrap();
    std::fs::write(place.join("argon"), &argon).unwrap();
    assert_exit(&run(place, "import -q --frame 1,3 argon -o s%03d%%.txt"), 0, "");
    let names = || {
        let mut names: Vec<_> =
            std::fs::read_dir(place).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(names(), ["argon", "argon 1", "s001%.txt", "s003%.txt"]);
    assert_exit(&run(place, "import --frame all argon"), 2, "need a number in the name");
    for (name, why) in [("a%s", "expected %d"), ("%d%d", "there twice"), ("%", "expected %d"), ("%3d", "expected %d")] {
        assert_exit(&run(place, &format!("import --frame all argon -o {name}")), 2, why);
    }
    assert_exit(&run(place, "import argon -o argon"), 6, "an input of this run");
    assert_exit(&run(place, "import argon -o nowhere/a.txt"), 6, "there is no folder");
    assert_exit(&run(place, "import --frame 4 argon -o b%d"), 3, "the file has 3");
    assert_eq!(names().len(), 4);
}
