//! The number types that a channel may be stored in, and the way from their bytes to `f32`.

use std::fmt;

use isolux::PixelFlags;

/// Type of one value of a channel, as stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ElementType {
    /// Boolean, one byte.
    Bool,
    /// Unsigned, 8 bit.
    U8,
    /// Unsigned, 16 bit.
    U16,
    /// Unsigned, 32 bit.
    U32,
    /// Unsigned, 64 bit.
    U64,
    /// Signed, 8 bit.
    I8,
    /// Signed, 16 bit.
    I16,
    /// Signed, 32 bit.
    I32,
    /// Signed, 64 bit.
    I64,
    /// IEEE half precision.
    F16,
    /// IEEE single precision.
    F32,
    /// IEEE double precision.
    F64,
    /// Complex, two of single precision.
    C64,
    /// Complex, two of double precision.
    C128,
}

/// Byte order of stored values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ByteOrder {
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

impl ByteOrder {
    /// The order of the machine that this runs on: that of values in memory.
    pub const NATIVE: Self = if cfg!(target_endian = "big") { Self::Big } else { Self::Little };
}

const TYPES: [(ElementType, &str, usize); 14] = [
    (ElementType::Bool, "bool", 1),
    (ElementType::U8, "uint8", 1),
    (ElementType::U16, "uint16", 2),
    (ElementType::U32, "uint32", 4),
    (ElementType::U64, "uint64", 8),
    (ElementType::I8, "int8", 1),
    (ElementType::I16, "int16", 2),
    (ElementType::I32, "int32", 4),
    (ElementType::I64, "int64", 8),
    (ElementType::F16, "float16", 2),
    (ElementType::F32, "float32", 4),
    (ElementType::F64, "float64", 8),
    (ElementType::C64, "complex64", 8),
    (ElementType::C128, "complex128", 16),
];

impl ElementType {
    /// Every type.
    pub fn all() -> impl Iterator<Item = Self> {
        TYPES.iter().map(|row| row.0)
    }

    /// Bytes of one value.
    #[must_use]
    pub const fn size_bytes(self) -> usize {
        TYPES[self as usize].2
    }

    /// The name of the type, e.g. `uint16` or `float32`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        TYPES[self as usize].1
    }

    /// True for the types that count: integers and booleans.
    #[must_use]
    pub const fn is_integer(self) -> bool {
        !matches!(self, Self::F16 | Self::F32 | Self::F64 | Self::C64 | Self::C128)
    }

    /// True for complex numbers: real and imaginary part stand one behind the other.
    #[must_use]
    pub const fn is_complex(self) -> bool {
        matches!(self, Self::C64 | Self::C128)
    }
}

impl fmt::Display for ElementType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A Rust type that channels are written from.
pub trait Element: Copy {
    /// The type it is stored as.
    const TYPE: ElementType;

    /// Appends the values' little-endian bytes.
    fn append_little_endian(values: &[Self], bytes: &mut Vec<u8>);
}

/// A number type whose values in memory can be looked at as bytes.
pub trait Number: Element {
    /// The bytes of the values, in the machine's own order.
    fn as_bytes(values: &[Self]) -> &[u8];
}

trait Stored: Copy {
    fn decode<T>(bytes: &[u8], order: ByteOrder, out: &mut [T], convert: impl Fn(Self) -> T);
}

macro_rules! stored {
    ($($type:ty => $element:ident),*) => {$(
        impl Stored for $type {
            #[inline(always)]
            fn decode<T>(bytes: &[u8], order: ByteOrder, out: &mut [T], convert: impl Fn(Self) -> T) {
                let (values, _) = bytes.as_chunks();
                match order {
                    ByteOrder::Little => {
                        out.iter_mut().zip(values).for_each(|(out, &v)| *out = convert(Self::from_le_bytes(v)));
                    }
                    ByteOrder::Big => {
                        out.iter_mut().zip(values).for_each(|(out, &v)| *out = convert(Self::from_be_bytes(v)));
                    }
                }
            }
        }

        impl Element for $type {
            const TYPE: ElementType = ElementType::$element;

            fn append_little_endian(values: &[Self], bytes: &mut Vec<u8>) {
                let start = bytes.len();
                bytes.resize(start + size_of_val(values), 0);
                let (out, _) = bytes[start..].as_chunks_mut();
                out.iter_mut().zip(values).for_each(|(out, value)| *out = value.to_le_bytes());
            }
        }

        impl Number for $type {
            fn as_bytes(values: &[Self]) -> &[u8] {
                bytemuck::cast_slice(values)
            }
        }
    )*};
}

stored!(u8 => U8, u16 => U16, u32 => U32, u64 => U64, i8 => I8, i16 => I16, i32 => I32, i64 => I64,
        f32 => F32, f64 => F64);

impl Element for PixelFlags {
    const TYPE: ElementType = ElementType::U16;

    fn append_little_endian(values: &[Self], bytes: &mut Vec<u8>) {
        bytes.extend(values.iter().flat_map(|value| value.bits().to_le_bytes()));
    }
}

macro_rules! decode_as {
    ($name:ident, $out:ty, $half:expr, $doc:literal) => {
        #[doc = $doc]
        pub(crate) fn $name(element: ElementType, order: ByteOrder, bytes: &[u8], out: &mut [$out]) {
            match element {
                ElementType::Bool => u8::decode(bytes, order, out, |v| <$out>::from(v != 0)),
                ElementType::U8 => u8::decode(bytes, order, out, |v| v as $out),
                ElementType::U16 => u16::decode(bytes, order, out, |v| v as $out),
                ElementType::U32 => u32::decode(bytes, order, out, |v| v as $out),
                ElementType::U64 => u64::decode(bytes, order, out, |v| v as $out),
                ElementType::I8 => i8::decode(bytes, order, out, |v| v as $out),
                ElementType::I16 => i16::decode(bytes, order, out, |v| v as $out),
                ElementType::I32 => i32::decode(bytes, order, out, |v| v as $out),
                ElementType::I64 => i64::decode(bytes, order, out, |v| v as $out),
                ElementType::F16 => u16::decode(bytes, order, out, $half),
                ElementType::F32 => f32::decode(bytes, order, out, |v| v as $out),
                ElementType::F64 => f64::decode(bytes, order, out, |v| v as $out),
                ElementType::C64 => f32::decode(bytes, order, out, |v| v as $out),
                ElementType::C128 => f64::decode(bytes, order, out, |v| v as $out),
            }
        }
    };
}

decode_as!(
    decode_f32,
    f32,
    f32_from_half,
    "Values of any type as f32: integers beyond 2²⁴ are rounded, a complex number counts as two values, real part first."
);
decode_as!(decode_f64, f64, |v| f64::from(f32_from_half(v)), "Values of any type as f64.");

/// The value that the bits of an IEEE half-precision number stand for: exact, every half is an f32.
fn f32_from_half(bits: u16) -> f32 {
    let (exponent, mantissa) = ((bits >> 10) & 0x1f, f32::from(bits & 0x3ff));
    let magnitude = match exponent {
        0 => mantissa * f32::powi(2.0, -24),
        31 if mantissa == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1.0 + mantissa / 1024.0) * f32::powi(2.0, i32::from(exponent) - 15),
    };
    if bits & 0x8000 == 0 { magnitude } else { -magnitude }
}

/// Appends the values' bytes in little-endian order.
pub(crate) fn append_as_little_endian(
    element: ElementType,
    order: ByteOrder,
    bytes: &[u8],
    out: &mut Vec<u8>,
) {
    let start = out.len();
    out.extend_from_slice(bytes);
    if order == ByteOrder::Big {
        let parts = if element.is_complex() { 2 } else { 1 };
        out[start..].chunks_exact_mut(element.size_bytes() / parts).for_each(<[u8]>::reverse);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_types() {
        for (position, element) in ElementType::all().enumerate() {
            assert_eq!(element as usize, position);
        }
    }

    #[test]
    fn every_type_reads_back_in_both_byte_orders() {
        let mut out = [0.0f64; 2];
        decode_f64(ElementType::I16, ByteOrder::Big, &[0xff, 0xfe, 0x01, 0x00], &mut out);
        assert_eq!(out, [-2.0, 256.0]);
        decode_f64(ElementType::I16, ByteOrder::Little, &[0xff, 0xfe, 0x01, 0x00], &mut out);
        assert_eq!(out, [-257.0, 1.0]);
        decode_f64(ElementType::C64, ByteOrder::Big, &[0x3f, 0x80, 0, 0, 0xc0, 0, 0, 0], &mut out);
        assert_eq!(out, [1.0, -2.0]);
        let mut little = Vec::new();
        append_as_little_endian(
            ElementType::C64,
            ByteOrder::Big,
            &[0x3f, 0x80, 0, 0, 0xc0, 0, 0, 0],
            &mut little,
        );
        assert_eq!(little, [0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0]);
        decode_f64(ElementType::Bool, ByteOrder::Little, &[7, 0], &mut out);
        assert_eq!(out, [1.0, 0.0]);
    }

    #[test]
    fn halves_are_exact() {
        let known = [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x0001, 5.960_464_5e-8),
            (0x0400, 6.103_515_6e-5),
            (0x3555, 0.333_251_95),
            (0x7c00, f32::INFINITY),
        ];
        for (bits, value) in known {
            assert_eq!(f32_from_half(bits), value, "{bits:#x}");
        }
        assert!(f32_from_half(0x7e00).is_nan());
        assert!(f32_from_half(0x8000).is_sign_negative());
    }
}
