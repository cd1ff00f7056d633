//! The header of a `.npy` file: magic, version, and a Python dictionary of element type, order and shape.
//! Format: NumPy enhancement proposal 1, and `numpy/lib/format.py`.

use std::io::{self, Read};

use crate::recording::element::{ByteOrder, ElementType};

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// A plain array's header is below 200 bytes; NumPy itself refuses to parse more than 10 000.
const LONGEST_HEADER_BYTES: usize = 1 << 16;

/// What a header says of the array behind it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NpyHeader {
    pub(crate) element: ElementType,
    pub(crate) byte_order: ByteOrder,
    /// True where the first index varies fastest.
    pub(crate) fortran_order: bool,
    pub(crate) dims: Vec<usize>,
    /// Bytes before the first value.
    pub(crate) data_offset: u64,
}

/// Why a header could not be understood.
#[derive(Debug)]
pub(crate) enum HeaderError {
    Io(io::Error),
    Content { found: String, expected: String },
}

fn unlike(found: impl Into<String>, expected: &str) -> HeaderError {
    HeaderError::Content { found: found.into(), expected: expected.to_owned() }
}

impl NpyHeader {
    /// Reads a header; takes no more from `reader` than the header.
    pub(crate) fn read(reader: &mut impl Read) -> Result<Self, HeaderError> {
        let start = read_up_to(reader, 8)?;
        if start.is_empty() {
            return Err(unlike("an empty file", "a .npy array"));
        }
        if !start.starts_with(MAGIC) {
            return Err(unlike(
                "other bytes than NumPy's signature",
                "a .npy array, as numpy.save writes it",
            ));
        }
        let length_bytes = match start.get(6..8) {
            Some([1, 0]) => 2,
            Some([2 | 3, 0]) => 4,
            Some(version) => {
                let found = format!("npy version {}.{}", version[0], version[1]);
                return Err(unlike(found, "version 1.0, 2.0 or 3.0"));
            }
            None => return Err(truncated()),
        };
        let length = read_up_to(reader, length_bytes)?;
        if length.len() < length_bytes {
            return Err(truncated());
        }
        let length = length.iter().rev().fold(0usize, |value, &byte| value << 8 | usize::from(byte));
        if length > LONGEST_HEADER_BYTES {
            let found = format!("a header of {length} bytes");
            return Err(unlike(found, &format!("at most {LONGEST_HEADER_BYTES}")));
        }
        let text = read_up_to(reader, length)?;
        if text.len() < length {
            return Err(truncated());
        }
        let text = std::str::from_utf8(&text)
            .map_err(|_| unlike("a header that is not text", "a Python dictionary"))?;
        Self::parse(text, (MAGIC.len() + 2 + length_bytes + length) as u64)
    }

    /// Parses the dictionary. The three keys may come in any order; others are not in the format.
    fn parse(text: &str, data_offset: u64) -> Result<Self, HeaderError> {
        let mut literal = Literal { rest: text };
        let (mut element, mut fortran_order, mut dims) = (None, None, None);
        literal.expect('{')?;
        while !literal.accept('}') {
            let key = literal.string()?;
            literal.expect(':')?;
            match key {
                "descr" => element = Some(literal.element()?),
                "fortran_order" => fortran_order = Some(literal.boolean()?),
                "shape" => dims = Some(literal.tuple()?),
                other => return Err(unlike(format!("header key '{}'", shorten(other)), EXPECTED_KEYS)),
            }
            if !literal.accept(',') {
                literal.expect('}')?;
                break;
            }
        }
        literal.expect_end()?;
        match (element, fortran_order, dims) {
            (Some((element, byte_order)), Some(fortran_order), Some(dims)) => {
                Ok(Self { element, byte_order, fortran_order, dims, data_offset })
            }
            _ => Err(unlike("a header with a key missing", EXPECTED_KEYS)),
        }
    }

    /// Bytes of the whole array; `None` beyond what can be counted.
    pub(crate) fn data_bytes(&self) -> Option<u64> {
        self.dims.iter().try_fold(self.element.size_bytes() as u64, |bytes, &dim| {
            bytes.checked_mul(u64::try_from(dim).ok()?)
        })
    }

    /// True when the values lie in C order, last index fastest. Both orders are the same thing where at most one
    /// dimension is longer than 1.
    pub(crate) fn is_c_order(&self) -> bool {
        !self.fortran_order || self.dims.iter().filter(|&&dim| dim > 1).count() <= 1
    }
}

/// The bytes of a version 1.0 header for a little-endian array in C order, padded as NumPy pads it so that the
/// data start at a multiple of 64 bytes.
pub(crate) fn header_bytes(element: ElementType, dims: &[usize]) -> Vec<u8> {
    let mut shape: String = dims.iter().map(|dim| format!("{dim}, ")).collect();
    if dims.len() > 1 {
        shape.truncate(shape.len() - 2);
    }
    let descr = element.npy_descr();
    let mut text =
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}), }}", shape.trim_end());
    let unpadded = MAGIC.len() + 4 + text.len() + 1;
    text.extend(std::iter::repeat_n(' ', unpadded.next_multiple_of(64) - unpadded));
    text.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes
}

const EXPECTED_KEYS: &str = "the keys 'descr', 'fortran_order' and 'shape'";

fn truncated() -> HeaderError {
    unlike("a file that ends inside its header", "a complete .npy array")
}

fn read_up_to(reader: &mut impl Read, bytes: usize) -> Result<Vec<u8>, HeaderError> {
    let mut buffer = Vec::new();
    reader.take(bytes as u64).read_to_end(&mut buffer).map_err(HeaderError::Io)?;
    Ok(buffer)
}

fn shorten(text: &str) -> String {
    text.chars().take(60).collect()
}

/// A cursor over a Python literal; knows no more of the language than headers use, and does not recurse.
struct Literal<'a> {
    rest: &'a str,
}

impl<'a> Literal<'a> {
    fn accept(&mut self, wanted: char) -> bool {
        let rest = self.rest.trim_start();
        let found = rest.strip_prefix(wanted);
        self.rest = found.unwrap_or(rest);
        found.is_some()
    }

    fn expect(&mut self, wanted: char) -> Result<(), HeaderError> {
        if self.accept(wanted) { Ok(()) } else { Err(self.unexpected(&format!("'{wanted}'"))) }
    }

    fn expect_end(&mut self) -> Result<(), HeaderError> {
        if self.rest.trim().is_empty() { Ok(()) } else { Err(self.unexpected("the header's end")) }
    }

    fn unexpected(&self, expected: &str) -> HeaderError {
        unlike(format!("\"{}\" in the header", shorten(self.rest.trim())), expected)
    }

    fn string(&mut self) -> Result<&'a str, HeaderError> {
        let quote = if self.accept('\'') { '\'' } else { '"' };
        if quote == '"' {
            self.expect('"')?;
        }
        let (text, rest) = self.rest.split_once(quote).ok_or_else(|| self.unexpected("a closing quote"))?;
        self.rest = rest;
        Ok(text)
    }

    fn boolean(&mut self) -> Result<bool, HeaderError> {
        for (word, value) in [("True", true), ("False", false)] {
            if let Some(rest) = self.rest.trim_start().strip_prefix(word) {
                self.rest = rest;
                return Ok(value);
            }
        }
        Err(self.unexpected("True or False"))
    }

    fn element(&mut self) -> Result<(ElementType, ByteOrder), HeaderError> {
        if self.rest.trim_start().starts_with(['[', '(']) {
            return Err(unlike(
                "a structured array",
                "an array of plain numbers, one .npy file for each field",
            ));
        }
        let descr = self.string()?;
        ElementType::from_npy_descr(descr).ok_or_else(|| {
            let kind = match descr.as_bytes().get(1) {
                Some(b'O') => "an array of Python objects",
                Some(b'c') => "an array of complex numbers",
                Some(b'S' | b'U' | b'a') => "an array of strings",
                Some(b'm' | b'M') => "an array of dates or durations",
                _ => "an array of another type",
            };
            let found = format!("{kind} (dtype '{}')", shorten(descr));
            unlike(
                found,
                "bool, (u)int8 to (u)int64, float16, float32 or float64; convert it with .astype(...)",
            )
        })
    }

    fn tuple(&mut self) -> Result<Vec<usize>, HeaderError> {
        self.expect('(')?;
        let mut dims = Vec::new();
        while !self.accept(')') {
            let rest = self.rest.trim_start();
            let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let dim = rest[..digits].parse().map_err(|_| self.unexpected("a dimension"))?;
            dims.push(dim);
            // Python 2 wrote long integers as 3L.
            self.rest = rest[digits..].strip_prefix('L').unwrap_or(&rest[digits..]);
            if !self.accept(',') {
                self.expect(')')?;
                break;
            }
        }
        Ok(dims)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<NpyHeader, HeaderError> {
        NpyHeader::parse(text, 128)
    }

    fn message(result: Result<NpyHeader, HeaderError>) -> String {
        match result.unwrap_err() {
            HeaderError::Io(error) => error.to_string(),
            HeaderError::Content { found, expected } => format!("found {found}, expected {expected}"),
        }
    }

    #[test]
    fn what_is_written_reads_back() {
        for dims in [vec![], vec![7], vec![7, 2], vec![1, 4, 3, 2]] {
            let bytes = header_bytes(ElementType::U16, &dims);
            let header = NpyHeader::read(&mut bytes.as_slice()).unwrap();
            assert_eq!(header.dims, dims);
            assert_eq!((header.element, header.byte_order), (ElementType::U16, ByteOrder::Little));
            assert_eq!(header.data_offset, bytes.len() as u64);
            assert_eq!(bytes.len() % 64, 0);
        }
    }

    #[test]
    fn headers_of_old_and_foreign_writers_are_read() {
        let header = parse("{\"shape\": (3L, 2L), \"descr\":'>f8', 'fortran_order' :True}").unwrap();
        assert_eq!(header.dims, [3, 2]);
        assert_eq!((header.element, header.byte_order), (ElementType::F64, ByteOrder::Big));
        assert!(!header.is_c_order());
        assert!(parse("{'descr': '<f4', 'fortran_order': True, 'shape': (1, 5, 1)}").unwrap().is_c_order());
    }

    #[test]
    fn unusable_headers_say_what_was_found() {
        let cases = [
            ("{'descr': '|O', 'fortran_order': False, 'shape': (3,), }", "Python objects"),
            ("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (3,), }", "structured"),
            ("{'descr': '<c8', 'fortran_order': False, 'shape': (3,), }", "complex"),
            ("{'descr': '<U8', 'fortran_order': False, 'shape': (3,), }", "strings"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (-3,), }", "expected a dimension"),
            (
                "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999999,), }",
                "a dimension",
            ),
            ("{'descr': '<f4', 'fortran_order': 0, 'shape': (3,), }", "True or False"),
            ("{'descr': '<f4', 'shape': (3,), }", "key missing"),
            ("{'descr': '<f4', 'colour': 3}", "header key 'colour'"),
            ("{'descr", "closing quote"),
            ("[[[[[[[[", "expected '{'"),
            ("", "expected '{'"),
        ];
        for (text, expected) in cases {
            let message = message(parse(text));
            assert!(message.contains(expected), "{text}: {message}");
        }
    }

    #[test]
    fn a_length_field_alone_allocates_nothing() {
        let bytes = b"\x93NUMPY\x02\x00\xff\xff\xff\xff{";
        let message = message(NpyHeader::read(&mut bytes.as_slice()));
        assert!(message.starts_with("found a header of 4294967295 bytes"), "{message}");
    }

    #[test]
    fn a_shape_beyond_counting_has_no_size() {
        let header =
            parse("{'descr': '<f8', 'fortran_order': False, 'shape': (4611686018427387904, 8)}").unwrap();
        assert_eq!(header.data_bytes(), None);
    }
}
