//! The header of a `.npy` file: magic, version, and a Python dictionary of element type, order and shape.
//! Format: NumPy enhancement proposal 1, and `numpy/lib/format.py`.

use std::io::Read;

use super::descr;
use super::header_error::{HeaderError, unlike};
use super::literal::{Literal, shorten};
use crate::recording::element::{ByteOrder, ElementType};

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// A plain array's header is below 200 bytes; NumPy itself refuses to parse more than 10 000.
const LONGEST_HEADER_BYTES: usize = 1 << 16;

/// The array that a header describes.
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
        let mut literal = Literal::new(text);
        let (mut element, mut fortran_order, mut dims) = (None, None, None);
        literal.expect('{')?;
        while !literal.accept('}') {
            let key = literal.string()?;
            literal.expect(':')?;
            match key {
                "descr" => element = Some(element_type(&mut literal)?),
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

fn element_type(literal: &mut Literal<'_>) -> Result<(ElementType, ByteOrder), HeaderError> {
    if literal.at_sequence() {
        return Err(unlike("a structured array", "an array of plain numbers, one .npy file for each field"));
    }
    descr::parse(literal.string()?)
}

/// The bytes of a version 1.0 header for a little-endian array in C order, padded as NumPy pads it so that the
/// data start at a multiple of 64 bytes; at least `least_bytes`, for a header that takes the place of a longer one.
pub(crate) fn header_bytes(element: ElementType, dims: &[usize], least_bytes: usize) -> Vec<u8> {
    let mut shape: String = dims.iter().map(|dim| format!("{dim}, ")).collect();
    if dims.len() > 1 {
        shape.truncate(shape.len() - 2);
    }
    let descr = descr::little_endian(element);
    let mut text =
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}), }}", shape.trim_end());
    let unpadded = MAGIC.len() + 4 + text.len() + 1;
    let padded = unpadded.max(least_bytes).next_multiple_of(64);
    text.extend(std::iter::repeat_n(' ', padded - unpadded));
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
            let bytes = header_bytes(ElementType::U16, &dims, 0);
            let header = NpyHeader::read(&mut bytes.as_slice()).unwrap();
            assert_eq!(header.dims, dims);
            assert_eq!((header.element, header.byte_order), (ElementType::U16, ByteOrder::Little));
            assert_eq!(header.data_offset, bytes.len() as u64);
            assert_eq!(bytes.len() % 64, 0);
            assert_eq!(header_bytes(ElementType::U16, &dims, 129).len(), 192);
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
            ("{'descr': '<c32', 'fortran_order': False, 'shape': (3,), }", "complex"),
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
