//! Picture files: exact bytes, nothing half-written, and every malformed kind with its message.

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;
use proptest::prelude::*;
use tempfile::TempDir;
use trueray::film::{
    Encoded, Format, Leniency, Picture, PictureError, PictureWriter, Problem, Reading, RowReader, Target, Warning,
    decode, read_picture,
};
use trueray::settings::Quantize;

/// A picture with all 256 sample values where it is large enough.
fn sample_picture(width: u32, height: u32) -> Picture {
    let rgb = (0..width * height * 3).map(|index| (index * 7 % 256) as u8).collect();
    Picture::new(width, height, rgb).unwrap()
}

fn in_folder(name: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    (folder, path)
}

fn names_in(folder: &TempDir) -> Vec<String> {
    fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

fn file_bytes(picture: &Picture, format: Format) -> Vec<u8> {
    let (_folder, path) = in_folder("picture");
    picture.save(&Target::File(path.clone()), format).unwrap();
    fs::read(path).unwrap()
}

fn strict(bytes: impl Into<Vec<u8>>) -> Result<Reading, Problem> {
    decode(bytes.into(), Leniency::Strict)
}

fn lenient(bytes: impl Into<Vec<u8>>) -> Result<Reading, Problem> {
    decode(bytes.into(), Leniency::Lenient(Quantize::Round))
}

/// The message of a strict reading's error.
#[track_caller]
fn refusal(bytes: impl Into<Vec<u8>>) -> String {
    strict(bytes).unwrap_err().to_string()
}

/// Samples and warnings of a lenient reading of what a strict one refuses and says to be mendable.
#[track_caller]
fn mended(bytes: &[u8]) -> (Vec<u8>, Vec<String>) {
    let refused = strict(bytes).unwrap_err();
    assert!(refused.lenient_helps(), "{refused}");
    let Reading { picture, warnings, .. } = lenient(bytes).unwrap();
    (picture.into_rgb(), warnings.iter().map(ToString::to_string).collect())
}

// --- pictures and formats -------------------------------------------------------------------------------------------

#[test]
fn pictures_fit_their_sides() {
    let picture = sample_picture(4, 3);
    assert_eq!((picture.width(), picture.height(), picture.pixel_count()), (4, 3, 12));
    assert_eq!(picture.pixel(1, 2), [27 * 7, 28 * 7, 203].map(|value| value as u8));
    assert_eq!(picture.rows().len(), 3);
    assert_eq!(picture.row(2)[1], picture.pixel(1, 2));
    assert_eq!(Picture::new(2, 1, vec![0; 5]), Err(PictureError::Samples { expected: 6, found: 5 }));
    assert_eq!(Picture::new(0, 1, vec![]), Err(PictureError::Sides { width: 0, height: 1 }));
    assert_eq!(Picture::new(u32::MAX, 1, vec![]), Err(PictureError::Sides { width: u32::MAX, height: 1 }));
}

#[test]
fn formats_by_name_and_extension() {
    for format in Format::ALL {
        assert_eq!(format.to_string().parse(), Ok(format));
        assert_eq!(format.to_string().to_uppercase().parse(), Ok(format));
    }
    let unknown = "exr".parse::<Format>().unwrap_err();
    assert_eq!(unknown, "`exr` is no picture format; there are p6, p3 and png");
    let by_extension = |name| Format::from_extension(Path::new(name));
    assert_eq!(by_extension("a/b.ppm"), Some(Format::P6));
    assert_eq!(by_extension("b.PNG"), Some(Format::Png));
    assert_eq!(by_extension("b.jpg"), None);
    assert_eq!(by_extension("png"), None);
}

#[test]
fn a_dash_is_standard_output() {
    assert_eq!(Target::from_argument("-".as_ref()), Target::Stdout);
    assert_eq!(Target::from_argument("./-".as_ref()), Target::File("./-".into()));
    assert_eq!(Target::Stdout.to_string(), "standard output");
}

// --- writing --------------------------------------------------------------------------------------------------------

#[test]
fn p6_to_the_byte() {
    let picture = Picture::new(2, 1, vec![0, 10, 255, 35, 13, 32]).unwrap();
    assert_eq!(file_bytes(&picture, Format::P6), b"P6\n2 1\n255\n\x00\x0a\xff\x23\x0d\x20");
}

#[test]
fn p3_to_the_byte() {
    let picture = Picture::new(6, 2, (0..36).map(|index| index * 7).collect()).unwrap();
    let expected = "P3\n6 2\n255\n\
        0 7 14 21 28 35 42 49 56 63 70 77 84 91 98\n\
        105 112 119\n\
        126 133 140 147 154 161 168 175 182 189 196 203 210 217 224\n\
        231 238 245\n";
    assert_eq!(String::from_utf8(file_bytes(&picture, Format::P3)).unwrap(), expected);
}

#[test]
fn p3_has_every_value_in_short_lines() {
    let picture = Picture::new(86, 1, (0..=255).chain([255, 255]).collect()).unwrap();
    let text = String::from_utf8(file_bytes(&picture, Format::P3)).unwrap();
    assert!(text.lines().all(|line| line.len() <= 70 && line == line.trim()));
    let samples: Vec<u8> = text.split_whitespace().skip(4).map(|sample| sample.parse().unwrap()).collect();
    assert_eq!(samples, picture.rgb());
}

#[test]
fn png_has_only_the_necessary_chunks() {
    let bytes = file_bytes(&sample_picture(50, 40), Format::Png);
    let mut chunks = Vec::new();
    let mut rest = &bytes[8..];
    while let Some(length) = rest.first_chunk() {
        chunks.push(String::from_utf8(rest[4..8].to_vec()).unwrap());
        rest = &rest[u32::from_be_bytes(*length) as usize + 12..];
    }
    chunks.dedup();
    assert_eq!(chunks, ["IHDR", "IDAT", "IEND"]);
    assert_eq!(bytes[24..26], [8, 2], "8 bits, RGB");
}

#[test]
fn every_format_round_trips_and_is_deterministic() {
    for (width, height) in [(1, 1), (5, 4), (101, 67)] {
        let picture = sample_picture(width, height);
        for format in Format::ALL {
            let bytes = file_bytes(&picture, format);
            let reading = strict(bytes.clone()).unwrap();
            assert!(reading.picture == picture && reading.warnings.is_empty(), "{format} {width}x{height}");
            assert_eq!(bytes, file_bytes(&picture, format));
        }
    }
}

#[test]
fn pieces_of_any_size_give_the_same_bytes() {
    let picture = sample_picture(37, 11);
    for format in Format::ALL {
        let whole = file_bytes(&picture, format);
        for piece in [1, 2, 3, 7, 15, 16, 110, 111, 112, 500] {
            let (_folder, path) = in_folder("picture");
            let mut writer = PictureWriter::create(&Target::File(path.clone()), format, 37, 11).unwrap();
            for rgb in picture.rgb().chunks(piece) {
                writer.write_rows(rgb).unwrap();
                writer.write_rows(&[]).unwrap();
            }
            writer.finish().unwrap();
            assert!(fs::read(path).unwrap() == whole, "{format} in pieces of {piece}");
        }
    }
}

#[test]
fn an_unfinished_picture_leaves_no_trace() {
    for format in Format::ALL {
        let (folder, path) = in_folder("old.ppm");
        fs::write(&path, "old").unwrap();
        let mut writer = PictureWriter::create(&Target::File(path.clone()), format, 4, 4).unwrap();
        writer.write_rows(&[1; 40]).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old", "while writing");
        drop(writer);
        assert_eq!((fs::read(&path).unwrap(), names_in(&folder)), (b"old".to_vec(), vec!["old.ppm".to_owned()]));

        let new = Target::File(folder.path().join("new.ppm"));
        drop(PictureWriter::create(&new, format, 4, 4).unwrap());
        assert_eq!(names_in(&folder), ["old.ppm"]);
    }
}

#[test]
fn a_finished_picture_replaces_the_old_file() {
    let (folder, path) = in_folder("picture.ppm");
    fs::write(&path, "old").unwrap();
    sample_picture(3, 3).save(&Target::File(path.clone()), Format::P6).unwrap();
    assert!(fs::read(&path).unwrap().starts_with(b"P6\n3 3\n255\n"));
    assert_eq!(names_in(&folder), ["picture.ppm"]);
}

#[test]
fn the_number_of_samples_must_fit() {
    for format in Format::ALL {
        let (folder, path) = in_folder("picture.ppm");
        let target = Target::File(path.clone());
        let mut writer = PictureWriter::create(&target, format, 2, 1).unwrap();
        writer.write_rows(&[0; 4]).unwrap();
        let excess = writer.write_rows(&[0; 3]).unwrap_err().to_string();
        assert_eq!(excess, format!("cannot write {target}: samples beyond the end of the picture: 1"));
        let missing = writer.finish().unwrap_err().to_string();
        assert_eq!(missing, format!("cannot finish {target}: samples missing at the end of the picture: 2"));
        assert!(names_in(&folder).is_empty());
    }
}

#[test]
fn what_cannot_be_created_is_named() {
    let (folder, path) = in_folder("missing/picture.ppm");
    let error = PictureWriter::create(&Target::File(path.clone()), Format::P6, 1, 1).unwrap_err();
    assert_eq!(error.kind(), std::io::ErrorKind::NotFound);
    let parent = path.parent().unwrap().display();
    assert_eq!(error.to_string(), format!("cannot create {}: there is no folder `{parent}`", path.display()));

    let directory = Target::File(folder.path().to_owned());
    let error = PictureWriter::create(&directory, Format::P6, 1, 1).unwrap_err();
    assert!(error.to_string().starts_with(&format!("cannot create {directory}: ")), "{error}");

    let error = PictureWriter::create(&Target::Stdout, Format::P6, 0, 5).unwrap_err();
    assert_eq!(error.to_string(), "cannot create standard output: a picture of 0x5 pixels has no pixels");
}

#[test]
fn writers_can_move_between_threads() {
    fn is_send<T: Send>() {}
    is_send::<PictureWriter>();
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o7777
    }

    #[test]
    fn permissions_are_those_of_an_ordinary_file() {
        let (folder, path) = in_folder("picture.png");
        let ordinary = folder.path().join("ordinary");
        fs::write(&ordinary, "").unwrap();
        sample_picture(1, 1).save(&Target::File(path.clone()), Format::Png).unwrap();
        assert_eq!(mode(&path), mode(&ordinary));

        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        sample_picture(2, 2).save(&Target::File(path.clone()), Format::Png).unwrap();
        assert_eq!(mode(&path), 0o640, "a replaced file's permissions are kept");
    }

    #[test]
    fn symbolic_links_stay_links() {
        let (folder, link) = in_folder("link.ppm");
        let real = folder.path().join("real.ppm");
        symlink("real.ppm", &link).unwrap();
        for _ in ["a dangling link", "a link to a file"] {
            sample_picture(2, 2).save(&Target::File(link.clone()), Format::P6).unwrap();
            assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
            assert!(fs::read(&real).unwrap().starts_with(b"P6\n2 2\n"));
            fs::write(&real, "old").unwrap();
        }
        drop(PictureWriter::create(&Target::File(link), Format::P6, 1, 1).unwrap());
        assert_eq!(fs::read(&real).unwrap(), b"old");
        assert_eq!(names_in(&folder).len(), 2);
    }

    #[test]
    fn devices_are_written_to_directly() {
        for format in Format::ALL {
            sample_picture(30, 30).save(&Target::File("/dev/null".into()), format).unwrap();
            assert!(!fs::symlink_metadata("/dev/null").unwrap().is_file());
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error_even_at_the_last_byte() {
        for format in Format::ALL {
            for size in [1, 300] {
                let error = sample_picture(size, size).save(&Target::File("/dev/full".into()), format).unwrap_err();
                assert_eq!(error.kind(), std::io::ErrorKind::StorageFull, "{format}");
                assert!(error.to_string().contains(" /dev/full: "), "{error}");
            }
        }
    }

    #[test]
    fn a_reader_that_goes_away_is_an_error() {
        let (_folder, path) = in_folder("fifo");
        let status = std::process::Command::new("mkfifo").arg(&path).status();
        if !status.is_ok_and(|status| status.success()) {
            eprintln!("skipped: no mkfifo here");
            return;
        }
        let reader = std::thread::spawn({
            let path = path.clone();
            move || drop(fs::File::open(path).unwrap())
        });
        let mut writer = PictureWriter::create(&Target::File(path), Format::P6, 1000, 1000).unwrap();
        reader.join().unwrap();
        let error = writer.write_rows(&vec![0; 3_000_000]).unwrap_err();
        assert_eq!(error.kind(), std::io::ErrorKind::BrokenPipe);
    }
}

// --- reading: what is right -----------------------------------------------------------------------------------------

#[test]
fn headers_may_have_comments_and_any_white_space() {
    let samples = [1, 2, 3, 4, 5, 6];
    for header in ["P6 2 1 255\n", "P6\n# a comment\n2 # width\n1\n255\t", "P6#\n#\n\n2\r\n\x0b1\x0c255 "] {
        let bytes = [header.as_bytes(), &samples].concat();
        assert_eq!(strict(bytes).unwrap().picture.rgb(), samples, "{header:?}");
    }
    for text in
        ["P3 2 1 255 1 2 3 4 5 6", "P3\n2\t1\r\n255#\n1 2 3#4\n4 05\n006 # end", "P3 2 1 255\n1\n2\n3\n4\n5\n6\n\n"]
    {
        assert_eq!(strict(text).unwrap().picture.rgb(), samples, "{text:?}");
    }
}

/// Netpbm's own: a comment stands for the line end that ends it, be that a line feed or a carriage return.
#[test]
fn comments_end_as_netpbm_has_it() {
    let samples = b"D \x82#\n\r";
    for header in [
        "P6\n2 1\n255# right after\n",
        "P6\n2 1\n255#\r",
        "P6\n# of a Mac\r2 1\n255\n",
        "P6#\r2#\r1#\r255 ",
        "P6\r2 1\r255\r",
    ] {
        let bytes = [header.as_bytes(), samples].concat();
        assert_eq!(strict(bytes).unwrap().picture.rgb(), samples, "{header:?}");
    }
    assert_eq!(strict("P3#\r1 1#\r255#\r1 2#\r3#").unwrap().picture.rgb(), [1, 2, 3]);
    // A comment that the file ends in takes the raster with it.
    assert!(refusal("P6 1 1 255# no end").contains("ends after 0 of 3 samples"));
    // White space before the comment ends the header, so that the comment is a part of the raster.
    assert_eq!(strict(*b"P6 1 1 255 # \n").unwrap().picture.rgb(), b"# \n");
    assert_eq!(
        refusal("P3\r1 1\r255\r1 2 x"),
        "line 4: sample 3 (x 0, y 0, blue) is `x`; samples are whole numbers from 0 to 255"
    );
}

#[test]
fn the_first_sample_may_look_like_white_space() {
    let reading = strict(*b"P6 1 1 255\n\n# ").unwrap();
    assert_eq!(reading.picture.rgb(), b"\n# ");
}

#[test]
fn other_maxima_are_scaled_with_rounding() {
    let reading = strict("P3 2 1 15 0 1 7 8 14 15").unwrap();
    assert_eq!(reading.picture.rgb(), [0, 17, 119, 136, 238, 255]);
    assert_eq!(reading.warnings, [Warning::Scaled { maximum: 15 }]);
    let reading = strict(*b"P6 1 1 1\n\x00\x01\x01").unwrap();
    assert_eq!(reading.picture.rgb(), [0, 255, 255]);
    // 100/200 of 255 is 127.5, rounded up.
    assert_eq!(strict("P3 1 1 200 0 100 200").unwrap().picture.rgb(), [0, 128, 255]);
}

#[test]
fn the_contents_decide_not_the_name() {
    let (_folder, path) = in_folder("picture.ppm");
    let picture = sample_picture(9, 5);
    picture.save(&Target::File(path.clone()), Format::Png).unwrap();
    assert!(read_picture(&path, Leniency::Strict).unwrap().picture == picture);
}

/// A PNG file as other programs write it.
fn foreign_png(width: u32, height: u32, color: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == png::ColorType::Indexed {
        encoder.set_palette(vec![9, 8, 7, 1, 2, 3]);
    }
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    bytes
}

#[test]
fn other_kinds_of_png() {
    use png::{BitDepth, ColorType};
    let rgb = |bytes| strict(bytes).unwrap().picture.into_rgb();
    assert_eq!(rgb(foreign_png(2, 1, ColorType::Grayscale, BitDepth::Eight, &[3, 250])), [3, 3, 3, 250, 250, 250]);
    assert_eq!(rgb(foreign_png(2, 1, ColorType::Grayscale, BitDepth::One, &[0x40])), [0, 0, 0, 255, 255, 255]);
    assert_eq!(rgb(foreign_png(2, 1, ColorType::Indexed, BitDepth::Two, &[0x40])), [1, 2, 3, 9, 8, 7]);
    assert_eq!(rgb(foreign_png(1, 1, ColorType::Rgba, BitDepth::Eight, &[1, 2, 3, 255])), [1, 2, 3]);
    assert_eq!(rgb(foreign_png(1, 1, ColorType::GrayscaleAlpha, BitDepth::Eight, &[7, 255])), [7, 7, 7]);

    let see_through = foreign_png(2, 1, ColorType::Rgba, BitDepth::Eight, &[1, 2, 3, 255, 4, 5, 6, 254]);
    assert_eq!(refusal(see_through.clone()), "the pixel at x 1, y 0 is not opaque");
    let (samples, warnings) = mended(&see_through);
    assert_eq!(samples, [1, 2, 3, 4, 5, 6]);
    assert_eq!(warnings, ["pixels not opaque, transparency ignored: 1"]);

    let deep = foreign_png(1, 1, ColorType::Rgb, BitDepth::Sixteen, &[255, 255, 1, 1, 0, 128]);
    assert_eq!(refusal(deep.clone()), "the PNG has 16 bits a channel; pictures here have 8");
    let (samples, warnings) = mended(&deep);
    assert_eq!(samples, [255, 1, 0]);
    assert_eq!(warnings, ["samples were scaled from 0..65535 to 0..255"]);
}

/// A PNG file of these chunks, each with its checksum.
fn png_of(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, data) in chunks {
        bytes.extend((data.len() as u32).to_be_bytes());
        let summed = [&name[..], data].concat();
        bytes.extend(&summed);
        bytes.extend(crc(&summed).to_be_bytes());
    }
    bytes
}

pub(crate) fn crc(bytes: &[u8]) -> u32 {
    let bit = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| bit(crc)))
}

/// `data` in the zlib format, not compressed.
fn stored(data: &[u8]) -> Vec<u8> {
    let length = data.len() as u16;
    let (a, b) = data.iter().fold((1_u32, 0_u32), |(a, b), &byte| {
        let a = (a + u32::from(byte)) % 65521;
        (a, (a + b) % 65521)
    });
    let head = [&[0x78, 0x01, 1][..], &length.to_le_bytes(), &(!length).to_le_bytes()].concat();
    [&head[..], data, &(b << 16 | a).to_be_bytes()].concat()
}

fn header(width: u32, height: u32, depth: u8, color: u8, interlaced: bool) -> Vec<u8> {
    [&width.to_be_bytes()[..], &height.to_be_bytes(), &[depth, color, 0, 0, interlaced.into()]].concat()
}

#[test]
fn interlaced_png() {
    // Of 2 × 2 pixels the passes are the first pixel, its right neighbour and the second row.
    let data = stored(&[0, 1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 10, 11, 12]);
    let bytes = png_of(&[(b"IHDR", &header(2, 2, 8, 2, true)), (b"IDAT", &data), (b"IEND", b"")]);
    assert_eq!(strict(bytes).unwrap().picture.rgb(), [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
    // Palette indices of two bits, passes one to a byte.
    let data = stored(&[0, 0x40, 0, 0x80, 0, 0x10]);
    let palette = [9, 9, 9, 1, 2, 3, 4, 5, 6];
    let chunks = [(b"IHDR", &header(2, 2, 2, 3, true)[..]), (b"PLTE", &palette), (b"IDAT", &data), (b"IEND", b"")];
    assert_eq!(strict(png_of(&chunks)).unwrap().picture.rgb(), [1, 2, 3, 4, 5, 6, 9, 9, 9, 1, 2, 3]);
}

#[test]
fn a_declared_colour_is_transparent() {
    let grey = |declared: &[u8]| {
        let chunks = [
            (b"IHDR", &header(2, 1, 4, 0, false)[..]),
            (b"tRNS", declared),
            (b"IDAT", &stored(&[0, 0x3c])),
            (b"IEND", b""),
        ];
        png_of(&chunks)
    };
    assert_eq!(strict(grey(&[0, 4])).unwrap().picture.rgb(), [51, 51, 51, 204, 204, 204]);
    assert_eq!(refusal(grey(&[0, 12])), "the pixel at x 1, y 0 is not opaque");
    assert_eq!(mended(&grey(&[0, 12])).0, [51, 51, 51, 204, 204, 204]);
    let palette = [
        (b"IHDR", &header(3, 2, 8, 3, false)[..]),
        (b"PLTE", &[1, 1, 1, 2, 2, 2]),
        (b"tRNS", &[0]),
        (b"IDAT", &stored(&[0, 1, 1, 1, 0, 1, 0, 0])),
        (b"IEND", b""),
    ];
    let (samples, warnings) = mended(&png_of(&palette));
    assert_eq!(samples[12..15], [1; 3]);
    assert_eq!(warnings, ["pixels not opaque, transparency ignored: 2"]);
    assert_eq!(refusal(png_of(&palette)), "the pixel at x 1, y 1 is not opaque");
    let rgb = [
        (b"IHDR", &header(1, 1, 8, 2, false)[..]),
        (b"tRNS", &[0, 1, 0, 2, 0, 3]),
        (b"IDAT", &stored(&[0, 1, 2, 3])),
        (b"IEND", b""),
    ];
    assert_eq!(refusal(png_of(&rgb)), "the pixel at x 0, y 0 is not opaque");
}

#[test]
fn chunks_about_colours_are_named() {
    let chunks = [
        (b"IHDR", &header(1, 1, 8, 0, false)[..]),
        (b"gAMA", &45455_u32.to_be_bytes()),
        (b"sRGB", &[0]),
        (b"iCCP", b"broken"),
        (b"tEXt", b"Comment\0gAMA"),
        (b"IDAT", &stored(&[0, 7])),
        (b"IEND", b""),
    ];
    let reading = strict(png_of(&chunks)).unwrap();
    assert_eq!(reading.picture.rgb(), [7; 3]);
    assert_eq!((reading.color_spaces, reading.warnings), (vec!["gAMA", "sRGB", "iCCP"], vec![]));
    assert!(strict(file_bytes(&sample_picture(3, 3), Format::Png)).unwrap().color_spaces.is_empty());
}

#[test]
fn sizes_are_known_before_anything_is_decoded() {
    let size = |bytes: &[u8]| Encoded::from_stream("x", bytes).and_then(|encoded| encoded.size());
    for format in Format::ALL {
        assert_eq!(size(&file_bytes(&sample_picture(7, 3), format)).unwrap(), (7, 3));
    }
    assert_eq!(size(b"P6 70000 3 255\n").unwrap(), (70000, 3));
    assert_eq!(size(b"P6 0 3 255\n").unwrap_err().to_string(), "x: line 1: a picture of 0x3 pixels has no pixels");
    // The file could hold so many black pixels, but nobody has room for them.
    let mut vast = png_of(&[(b"IHDR", &header(65528, 65535, 1, 0, false)), (b"IDAT", &[0; 1000])]);
    vast.resize(600_000, 0);
    let expected = "the header promises 65528x65535 pixels; at most 1073741824 are read";
    assert_eq!(size(&vast).unwrap_err().to_string(), format!("x: {expected}"));
    assert_eq!(refusal(vast.clone()), expected);
    assert_eq!(lenient(vast).unwrap_err().to_string(), expected);
}

// --- reading: what is wrong -----------------------------------------------------------------------------------------

#[test]
fn errors_name_the_file() {
    let (_folder, path) = in_folder("bad.ppm");
    let name = path.display().to_string();
    let message = |path: &Path| read_picture(path, Leniency::Strict).unwrap_err().to_string();
    assert!(message(&path).starts_with(&format!("{name}: ")), "{}", message(&path));
    fs::write(&path, "P3\n1 1\n255\n1 2").unwrap();
    assert!(message(&path).starts_with(&format!("{name}: line 4: ")), "{}", message(&path));
    assert!(message(path.parent().unwrap()).contains("directory"));
}

#[test]
fn files_that_are_no_picture() {
    for (bytes, expected) in [
        (&b""[..], "the file is empty; "),
        (b"P", "no known picture format; "),
        (b"p6 1 1 255 abc", "PPM starts with a capital P; "),
        (b"P5 1 1 255 a", "this is PGM, shades of grey; "),
        (b"\xff\xd8\xff\xe0", "this is JPEG, which does not keep pixels exactly; "),
        (b"\xef\xbb\xbfP3 1 1 255 1 2 3", "the file starts with a byte order mark; "),
        (b"\x89PNG\n\x1a\n", "this is PNG with a damaged start (transferred as text?); "),
        (b"NEAR 1\nLEFT -1\n", "no known picture format; "),
    ] {
        assert_eq!(refusal(bytes), format!("{expected}wanted is PPM (P6 or P3) or PNG"));
        assert!(lenient(bytes).is_err());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn endless_files_are_not_read_to_the_end() {
    assert!(read_picture(Path::new("/dev/zero"), Leniency::Lenient(Quantize::Round)).is_err());
}

#[test]
fn malformed_headers() {
    for (text, expected) in [
        ("P6", "line 1: the file ends where the width should stand"),
        ("P6\n# only\n3", "line 3: the file ends where the height should stand"),
        ("P3 2 2", "line 1: the file ends where the maximum should stand"),
        ("P65 4 255\n", "line 1: white space must follow the P3 or P6"),
        ("P3\n-5 4 255", "line 2: the width is -5; it must be a whole number"),
        ("P3\n5 4.0 255", "line 2: the height is `4.0`; it must be a whole number"),
        ("P3\n5 +4 255", "line 2: the height is `+4`; it must be a whole number"),
        ("P3\n99999999999 4 255", "line 2: the width is 99999999999; it must be a whole number"),
        ("P3\n0 4 255", "line 2: a picture of 0x4 pixels has no pixels"),
        ("P6\n4 0\n255\n", "line 2: a picture of 4x0 pixels has no pixels"),
        ("P6\n4000000000 1\n255\n", "line 2: a picture of 4000000000x1 pixels is too large"),
        ("P3 1 1\n0\n0 0 0", "line 2: the maximum is 0; it must be 1 to 65535"),
        ("P3 1 1\n65536\n0 0 0", "line 2: the maximum is 65536; it must be 1 to 65535"),
        ("P6 1 1 255x\nabc", "line 1: the maximum is `255x`; it must be a whole number"),
    ] {
        assert_eq!(refusal(text), expected, "{text:?}");
        assert!(lenient(text).is_err(), "{text:?}");
        assert!(!strict(text).unwrap_err().lenient_helps());
    }
}

#[test]
fn samples_out_of_range() {
    let text = "P3\n2 2\n255\n1 2 3 4 257 6\n7 296 9 10 11\n-4\n";
    assert_eq!(refusal(text), "line 4: sample 5 (x 1, y 0, green) is 257; samples are whole numbers from 0 to 255");
    assert_eq!(
        refusal("P3 1 1 255\n1\n2\n-4"),
        "line 4: sample 3 (x 0, y 0, blue) is -4; samples are whole numbers from 0 to 255"
    );
    let huge = "P3 1 1 255 1 123456789012345678901234567890 3";
    assert!(refusal(huge).contains("sample 2 (x 0, y 0, green) is 12345678901234567890...;"));
    assert_eq!(mended(huge.as_bytes()).0, [1, 255, 3]);

    let (samples, warnings) = mended(text.as_bytes());
    assert_eq!(samples, [1, 2, 3, 4, 255, 6, 7, 255, 9, 10, 11, 0]);
    assert_eq!(warnings, ["samples out of range, clamped: 3; the first at line 4: sample 5 (x 1, y 0, green) is 257"]);

    let binary = b"P6 1 1 100\n\x64\x65\x00";
    assert_eq!(refusal(*binary), "byte 12: sample 2 (x 0, y 0, green) is 101; samples are whole numbers from 0 to 100");
    assert_eq!(mended(binary).0, [255, 255, 0]);
    assert_eq!(strict("P3 1 1 255 -0 0 0").unwrap().picture.rgb(), [0, 0, 0]);
}

#[test]
fn samples_that_are_no_numbers() {
    for (token, shown) in [("nan", "`nan`"), ("1.5", "`1.5`"), ("0x10", "`0x10`"), ("-", "`-`"), ("\u{1}", r"`\x01`")] {
        let text = format!("P3 1 1 255\n1 {token} 3");
        let expected =
            format!("line 2: sample 2 (x 0, y 0, green) is {shown}; samples are whole numbers from 0 to 255");
        assert_eq!(refusal(text.clone()), expected);
        assert!(!strict(text.clone()).unwrap_err().lenient_helps());
        assert_eq!(lenient(text).unwrap_err().to_string(), expected);
    }
}

#[test]
fn truncated_files() {
    let text = "P3\n2 2\n255\n1 2 3 4\n5 6 7\n";
    assert_eq!(refusal(text), "line 6: the file ends after 7 of 12 samples; sample 8 (x 0, y 1, green) is missing");
    let (samples, warnings) = mended(text.as_bytes());
    assert_eq!(samples, [1, 2, 3, 4, 5, 6, 7, 0, 0, 0, 0, 0]);
    assert_eq!(warnings, ["missing samples, taken as 0: 5, from sample 8 (x 0, y 1, green) on"]);

    let binary = b"P6\n2 2\n255\nabcd";
    assert_eq!(refusal(*binary), "byte 15: the file ends after 4 of 12 samples; sample 5 (x 1, y 0, green) is missing");
    assert_eq!(mended(binary).0, b"abcd\0\0\0\0\0\0\0\0");
    assert_eq!(mended(b"P6 1 1 255").0, [0, 0, 0]);
}

#[test]
fn trailing_data() {
    let text = "P3\n1 1\n255\n1 2 3\n\n77 88\n";
    assert_eq!(refusal(text), "line 6: unexpected 77 after the last of 3 samples");
    let (samples, warnings) = mended(text.as_bytes());
    assert_eq!(samples, [1, 2, 3]);
    assert_eq!(warnings, ["data after the last sample, ignored: 6 bytes"]);

    let binary = b"P6\n1 1\n255\nabcde";
    assert_eq!(refusal(*binary), "byte 14: unexpected data (2 bytes) after the last of 3 samples");
    let (samples, warnings) = mended(binary);
    assert_eq!(samples, b"abc");
    assert_eq!(warnings, ["data after the last sample, ignored: 2 bytes"]);
}

#[test]
fn pixel_data_beyond_the_picture_of_a_png() {
    let surplus = "the PNG has more pixel data than its picture";
    // A filter's byte and three samples.
    let (row, more, header) = ([0, 1, 2, 3], [0, 1, 2, 3, 0], header(1, 1, 8, 2, false));
    let png = |parts: &[&[u8]]| {
        let mut chunks: Vec<(&[u8; 4], &[u8])> = vec![(b"IHDR", &header)];
        chunks.extend(parts.iter().map(|part| (b"IDAT", *part)));
        png_of(&[&chunks[..], &[(b"IEND", b"")]].concat())
    };
    let stream = stored(&row);
    assert_eq!(strict(png(&[&stream])).unwrap().picture.into_rgb(), [1, 2, 3]);
    // Split anywhere, also into chunks of nothing.
    assert_eq!(strict(png(&[b"", &stream[..5], b"", &stream[5..], b""])).unwrap().picture.into_rgb(), [1, 2, 3]);
    for wrong in [png(&[&stored(&more)]), png(&[&stream, b"x"]), png(&[&[&stream[..], b"x"].concat()])] {
        assert_eq!(refusal(wrong.clone()), surplus);
        assert_eq!(mended(&wrong), (vec![1, 2, 3], vec![format!("{surplus}, ignored")]));
        let (_folder, path) = in_folder("picture.png");
        fs::write(&path, wrong).unwrap();
        assert!(RowReader::open(&path).unwrap().check().unwrap_err().to_string().ends_with(surplus));
    }
}

#[test]
fn a_binary_header_that_ends_in_two_bytes() {
    let bytes = b"P6\r\n1 1\r\n255\r\nabc";
    assert_eq!(refusal(*bytes), "the header ends in CR LF where one byte is allowed (written in text mode?)");
    let (samples, warnings) = mended(bytes);
    assert_eq!(samples, b"abc");
    assert_eq!(warnings, ["the header ends in CR LF; the LF was taken as part of it"]);
}

#[test]
fn sixteen_bits() {
    let binary = b"P6 1 1 65535\n\xff\xff\x80\x00\x00\x00";
    assert_eq!(refusal(*binary), "samples up to 65535 take 16 bits; pictures here have 8 bits a channel");
    assert_eq!(mended(binary), (vec![255, 128, 0], vec!["samples were scaled from 0..65535 to 0..255".to_owned()]));
    assert_eq!(mended(b"P3 1 1 1000 0 500 1001").0, [0, 128, 255]);
    // By the rule that has made them, of 8 bits as of 16.
    let by = |rule| decode(binary.to_vec(), Leniency::Lenient(rule)).unwrap().picture.rgb().to_vec();
    assert_eq!(by(Quantize::Truncate), [255, 127, 0]);
    for rule in [Quantize::Truncate, Quantize::Round] {
        for step in 0..100_000 {
            let color = DVec3::splat(f64::from(step) / 99_999.0);
            let narrowed = rule.levels16(color).map(|level| rule.narrowed(level.into(), 65535));
            assert_eq!(narrowed, rule.levels(color), "{rule:?} of {color}");
        }
    }
    // Half a sample is none.
    assert_eq!(mended(b"P6 1 1 65535\n\xff\xff\x80").0, [255, 0, 0]);
}

#[test]
fn a_header_alone_takes_no_memory() {
    for magic in ["P3", "P6"] {
        let text = format!("{magic}\n1000000000 1000000000\n255\n");
        assert!(refusal(text.clone()).contains("ends after 0 of 3000000000000000000 samples"));
        let message = lenient(text).unwrap_err().to_string();
        assert_eq!(message, "the header promises 1000000000x1000000000 pixels, more than the file can hold");
    }
    let mut bytes = file_bytes(&sample_picture(3, 3), Format::Png);
    bytes[16..24].copy_from_slice(&[0x3b, 0x9a, 0xca, 0x00, 0x3b, 0x9a, 0xca, 0x00]);
    let message = refusal(bytes);
    assert_eq!(message, "the header promises 1000000000x1000000000 pixels, more than the file can hold");
}

#[test]
fn damaged_png() {
    let bytes = file_bytes(&sample_picture(40, 40), Format::Png);
    for cut in [8, 20, 33, 50, bytes.len() / 2] {
        let message = refusal(&bytes[..cut]);
        assert!(message.starts_with("damaged PNG: "), "{message}");
    }
    let expected = "data after the end of the PNG: 1 byte";
    let longer = [&bytes[..], b"x"].concat();
    assert_eq!(refusal(longer.clone()), expected);
    let (samples, warnings) = mended(&longer);
    assert_eq!(samples, sample_picture(40, 40).rgb());
    assert_eq!(warnings, ["data after the end of the PNG, ignored: 1 byte"]);
    for cut in bytes.len() - 20..bytes.len() {
        assert!(strict(&bytes[..cut]).is_err(), "{cut}");
    }
    // Up to its last chunk no pixel is missing.
    for cut in bytes.len() - 12..bytes.len() {
        let expected = "the PNG is cut off after its pixels: it does not end with its IEND chunk";
        assert_eq!(refusal(&bytes[..cut]), expected);
        let (samples, warnings) = mended(&bytes[..cut]);
        assert_eq!(samples, sample_picture(40, 40).rgb());
        assert_eq!(warnings, ["the PNG does not end with its IEND chunk; its pixels are complete"]);
    }
    assert!(lenient(&bytes[..bytes.len() - 13]).is_err(), "the checksum of the pixels");
    // A second picture ends with such a chunk, too.
    let twice = [&bytes[..], &bytes].concat();
    assert_eq!(refusal(twice.clone()), format!("data after the end of the PNG: {} bytes", bytes.len()));
    assert_eq!(mended(&twice).0, sample_picture(40, 40).rgb());
    let mut flipped = bytes;
    flipped[100] ^= 1;
    assert!(refusal(flipped).starts_with("damaged PNG: "));
}

#[test]
fn damaged_palettes() {
    let indexed = |palette: &[u8], depth: u8, data: &[u8]| {
        let header = header(3, 2, depth, 3, false);
        let png = png_of(&[(b"IHDR", &header), (b"PLTE", palette), (b"IDAT", &stored(data)), (b"IEND", b"")]);
        (strict(png.clone()).map(|reading| reading.picture.into_rgb()), lenient(png))
    };
    let (good, _) = indexed(&[1, 2, 3, 4, 5, 6], 4, &[0, 0x01, 0, 0, 0x10, 0]);
    assert_eq!(good.unwrap(), [1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6, 1, 2, 3, 1, 2, 3]);
    let (strict, lenient) = indexed(&[1, 2, 3, 4, 5, 6], 4, &[0, 0x01, 0, 0, 0x12, 0]);
    let expected = "damaged PNG: the pixel at x 1, y 1 has index 2 in a palette of 2 colours";
    assert_eq!(strict.unwrap_err().to_string(), expected);
    assert_eq!(lenient.unwrap_err().to_string(), expected);
    for palette in [&[1, 2, 3, 4][..], &[1], &[1, 2]] {
        let (strict, lenient) = indexed(palette, 8, &[0; 8]);
        let message = strict.unwrap_err().to_string();
        assert!(message.starts_with("damaged PNG: the palette has ") && lenient.is_err(), "{message}");
    }
}

// --- properties -----------------------------------------------------------------------------------------------------

fn pictures() -> impl Strategy<Value = Picture> {
    (1_u32..20, 1_u32..20).prop_flat_map(|(width, height)| {
        proptest::collection::vec(any::<u8>(), (width * height * 3) as usize)
            .prop_map(move |rgb| Picture::new(width, height, rgb).unwrap())
    })
}

fn formats() -> impl Strategy<Value = Format> {
    proptest::sample::select(Format::ALL.as_slice())
}

fn read_both(bytes: &[u8]) -> [Result<Reading, Problem>; 2] {
    [strict(bytes), lenient(bytes)]
}

proptest! {
    #[test]
    fn any_picture_round_trips(picture in pictures(), format in formats()) {
        prop_assert!(strict(file_bytes(&picture, format)).unwrap().picture == picture);
    }

    #[test]
    fn garbage_is_never_fatal(
        magic in proptest::sample::select(vec![&b""[..], b"P3", b"P6 ", b"P3\n3 2\n255\n", b"P6 3 2 9\n", b"\x89PNG\r\n\x1a\n"]),
        garbage in proptest::collection::vec(any::<u8>(), 0..200),
    ) {
        let _ = read_both(&[magic, &garbage].concat());
    }

    #[test]
    fn text_is_never_fatal(text in "P[36][ \n#0-9-]{0,60}") {
        for reading in read_both(text.as_bytes()).into_iter().flatten() {
            prop_assert!(reading.picture.pixel_count() > 0);
        }
    }

    #[test]
    fn a_damaged_file_is_never_fatal(
        picture in pictures(),
        format in formats(),
        damage in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..4),
        end in any::<proptest::sample::Index>(),
    ) {
        let mut bytes = file_bytes(&picture, format);
        for (at, value) in damage {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let _ = read_both(&bytes);
        let _ = read_both(&bytes[..end.index(bytes.len())]);
    }

    #[test]
    fn lenient_agrees_with_strict(text in "P3 [1-3] [1-3] 255( [0-9]{1,3}){0,30}") {
        if let Ok(reading) = strict(text.clone()) {
            let again = lenient(text).unwrap();
            prop_assert!(again.picture == reading.picture && again.warnings == reading.warnings);
        }
    }
}
