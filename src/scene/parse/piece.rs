//! Large files in pieces, on all threads: what has spheres and lights alone, and nothing to say of them, needs to know nothing of
//! what is before it.

use rayon::prelude::*;

use super::{Parser, Tokens, first_line};
use crate::scene::diagnostics::Line;

/// Bytes of a piece: some thousand statements.
pub(super) const SIZE: usize = 1 << 18;
/// Pieces for each thread that are read at once, so that one that is slow keeps none waiting.
const EACH: usize = 4;

/// A piece that has been read.
struct Read<'a> {
    text: &'a [u8],
    parser: Parser<'a>,
    /// Its last line, by its number in the piece.
    last: Line<'a>,
}

impl<'a> Parser<'a> {
    /// Reads all lines, in pieces of so many bytes; the last of them.
    pub(super) fn lines(&mut self, text: &'a [u8], size: usize) -> Line<'a> {
        let mut line = Line { number: 0, bytes: b"" };
        let mut rest = text;
        while rest.len() > size {
            let pieces = pieces(rest, size, EACH * rayon::current_num_threads());
            let read: Vec<Read> = pieces.into_par_iter().map(Read::new).collect();
            let mut are_all_odd = true;
            for Read { text, parser, last } in read {
                if parser.is_plain() {
                    are_all_odd = false;
                    self.append(parser);
                    line = Line { number: line.number + last.number, ..last };
                } else {
                    line = self.in_turn(rest, text.len(), line);
                }
                rest = &rest[text.len()..];
            }
            if are_all_odd {
                break;
            }
        }
        self.in_turn(rest, rest.len(), line)
    }

    /// Reads the lines in the first bytes of `text`, which follow `line`; the last of them.
    fn in_turn(&mut self, text: &'a [u8], bytes: usize, mut line: Line<'a>) -> Line<'a> {
        let mut tokens = Tokens::new();
        let mut rest = text;
        while rest.len() > text.len() - bytes {
            let (bytes, taken) = first_line(rest);
            rest = &rest[taken..];
            line = Line { number: line.number + 1, bytes };
            self.rest = rest;
            tokens.split(bytes);
            self.statement(line, &tokens);
        }
        line
    }

    /// Whether there are only spheres and lights, and nothing is to be said of them.
    fn is_plain(&self) -> bool {
        let has_none = self.collector.error_count() == 0 && self.collector.warning_count() == 0;
        has_none && self.singles.iter().all(Option::is_none)
    }

    fn append(&mut self, mut other: Self) {
        self.spheres.append(&mut other.spheres);
        self.sphere_names.append(&other.sphere_names);
        self.lights.append(&mut other.lights);
        self.light_names.append(&other.light_names);
    }
}

impl<'a> Read<'a> {
    fn new(text: &'a [u8]) -> Self {
        let mut parser = Parser::default();
        let last = parser.in_turn(text, text.len(), Line { number: 0, bytes: b"" });
        Self { text, parser, last }
    }
}

/// The first pieces of `text`, at the most so many, each of whole lines.
fn pieces(text: &[u8], size: usize, most: usize) -> Vec<&[u8]> {
    let mut rest = text;
    let next = |_| {
        // Every line feed ends a line; where there is none, carriage returns do.
        let end = rest.get(size..).and_then(|beyond| memchr::memchr(b'\n', beyond));
        let (piece, beyond) = rest.split_at(end.map_or(rest.len(), |end| size + end + 1));
        rest = beyond;
        (!piece.is_empty()).then_some(piece)
    };
    (0..most).map_while(next).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parse::{Parsed, parse};

    fn in_pieces(text: &str, size: usize) -> Parsed {
        let mut parser = Parser::default();
        parser.run(text.as_bytes(), size);
        parser.finish("test")
    }

    /// Whatever the pieces are, the file is read as a whole is.
    #[test]
    fn pieces_are_read_as_the_whole() {
        const HEAD: &str = "NEAR 1\nLEFT -1\nRIGHT 1\r\nBOTTOM -1\nTOP 1\nRES 4 4\n";
        let spheres: String = (0..40).map(|k| format!("SPHERE s{k} {k} 0 -9 1 1 1 1 1 1 1 1 1 1 1\n")).collect();
        let light = "LIGHT l 1 2 3 1 1 1 # a lamp\n\nBACK 1 0 0\n";
        for text in [
            format!("{HEAD}{spheres}{light}{spheres}AMBIENT 1 1 1"),
            format!("{spheres}{HEAD}SPHERE s 1 2\n3 1 1 1 1 1 1 1 1 1 1\n{spheres}"),
            format!("{HEAD}{spheres}SPHERE w 0 0 -9 1 1 1 2 1 1 1 1 1 1 1\n{spheres}SPHEER x\n{spheres}NEAR 3\n"),
            format!("{HEAD}{spheres}").replace('\n', "\r"),
            format!("{HEAD}{spheres}").replace('\n', "\r\n"),
            format!("{spheres}\n\n# nothing else\n\n"),
        ] {
            let whole = parse("test", text.as_bytes());
            for size in [1, 30, 64, 200, 1000] {
                let found = in_pieces(&text, size);
                assert_eq!(found.scene, whole.scene, "{size}: {text}");
                assert_eq!(found.report(false), whole.report(false), "{size}: {text}");
                assert_eq!((found.errors, found.warnings), (whole.errors, whole.warnings));
            }
        }
    }
}
