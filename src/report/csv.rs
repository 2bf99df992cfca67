//! CSV (RFC 4180), except that lines end as everywhere else here, and that no field has several.

use std::ops::Range;

/// One record; fields with separators or quotes are quoted.
pub(crate) fn record(fields: &[String]) -> String {
    let quoted = |field: &String| {
        if field.contains([',', '"', '\n', '\r']) {
            format!("\"{}\"", field.replace('"', "\"\""))
        } else {
            field.clone()
        }
    };
    fields.iter().map(quoted).collect::<Vec<_>>().join(",") + "\n"
}

/// A field as it was read.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Cell {
    /// Its bytes in the line, quotes included and blanks around it not.
    pub(crate) range: Range<usize>,
    /// What they say.
    pub(crate) text: Vec<u8>,
}

/// The fields of one line; blanks around them do not count.
///
/// # Errors
///
/// Where a quote begins that does not end in this line.
pub(crate) fn cells(line: &[u8]) -> Result<Vec<Cell>, usize> {
    let mut cells = Vec::new();
    let mut at = 0;
    loop {
        at += line[at..].iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count();
        let (start, mut text, mut is_quoted, mut quoted) = (at, Vec::new(), false, 0);
        while let Some(&byte) = line.get(at).filter(|&&byte| is_quoted || byte != b',') {
            match byte {
                b'"' if is_quoted && line.get(at + 1) == Some(&b'"') => {
                    text.push(b'"');
                    at += 1;
                }
                b'"' if is_quoted || at == start => (is_quoted, quoted) = (!is_quoted, text.len()),
                byte => text.push(byte),
            }
            at += 1;
        }
        if is_quoted {
            return Err(start);
        }
        let end = start + line[start..at].trim_ascii_end().len();
        text.truncate(text.trim_ascii_end().len().max(quoted));
        cells.push(Cell { range: start..end, text });
        if at == line.len() {
            return Ok(cells);
        }
        at += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(line: &str) -> Vec<String> {
        let cells = cells(line.as_bytes()).expect("the quotes are closed");
        cells.into_iter().map(|cell| String::from_utf8_lossy(&cell.text).into_owned()).collect()
    }

    #[test]
    fn what_is_written_is_read() {
        let fields = ["", "a b", "a,b", "say \"a\"", "1", ""].map(str::to_owned);
        assert_eq!(texts(record(&fields).trim_end()), fields);
    }

    #[test]
    fn blanks_around_fields_do_not_count() {
        assert_eq!(texts(" 1 ,\t2,\" 3 \" ,, "), ["1", "2", " 3 ", "", ""]);
        assert_eq!(cells(b"1, 22 ,3").map(|cells| cells[1].range.clone()), Ok(3..5));
    }

    #[test]
    fn an_open_quote_is_found() {
        assert_eq!(cells(b"1,\"2,3"), Err(2));
    }
}
