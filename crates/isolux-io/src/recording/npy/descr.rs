//! How NumPy spells element types: the `descr` of a header.

use super::header_error::{HeaderError, unlike};
use super::literal::shorten;
use crate::recording::element::{ByteOrder, ElementType};

/// Type and size in bytes, as they follow the byte order.
const fn code(element: ElementType) -> &'static str {
    match element {
        ElementType::Bool => "b1",
        ElementType::U8 => "u1",
        ElementType::U16 => "u2",
        ElementType::U32 => "u4",
        ElementType::U64 => "u8",
        ElementType::I8 => "i1",
        ElementType::I16 => "i2",
        ElementType::I32 => "i4",
        ElementType::I64 => "i8",
        ElementType::F16 => "f2",
        ElementType::F32 => "f4",
        ElementType::F64 => "f8",
        ElementType::C64 => "c8",
        ElementType::C128 => "c16",
    }
}

/// The `descr` of little-endian values.
pub(super) fn little_endian(element: ElementType) -> String {
    let order = if element.size_bytes() == 1 { '|' } else { '<' };
    format!("{order}{}", code(element))
}

/// Type and byte order from a `descr`, or what else it stands for.
pub(super) fn parse(descr: &str) -> Result<(ElementType, ByteOrder), HeaderError> {
    plain_number(descr).ok_or_else(|| {
        let kind = match descr.as_bytes().get(1) {
            Some(b'O') => "an array of Python objects",
            Some(b'c') => "an array of complex numbers",
            Some(b'S' | b'U' | b'a') => "an array of strings",
            Some(b'm' | b'M') => "an array of dates or durations",
            _ => "an array of another type",
        };
        let found = format!("{kind} (dtype '{}')", shorten(descr));
        unlike(found, "bool, (u)int8 to (u)int64, float16, float32, float64, complex64 or complex128; convert it with .astype(...)")
    })
}

fn plain_number(descr: &str) -> Option<(ElementType, ByteOrder)> {
    let (order, rest) = descr.split_at_checked(1)?;
    let element = ElementType::all().find(|&element| code(element) == rest)?;
    match order {
        "<" => Some((element, ByteOrder::Little)),
        ">" => Some((element, ByteOrder::Big)),
        "|" if element.size_bytes() == 1 => Some((element, ByteOrder::Little)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn descriptions_of_real_numbers_are_understood_and_others_are_not() {
        assert_eq!(plain_number(">u2"), Some((ElementType::U16, ByteOrder::Big)));
        assert_eq!(plain_number("|b1"), Some((ElementType::Bool, ByteOrder::Little)));
        for descr in ["|O", "<U3", "<c32", "<f16", "|u2", "=f4", "", "é4", "<m8[us]"] {
            assert_eq!(plain_number(descr), None, "{descr}");
        }
        for element in ElementType::all() {
            assert_eq!(plain_number(&little_endian(element)), Some((element, ByteOrder::Little)));
        }
    }
}
