//! `.npy` files made byte by byte, independently of the crate's own writer. The command line's tests use them too.

/// An array as NumPy would save it; the values are given in C order.
#[derive(Clone, Debug)]
pub struct Array {
    pub descr: String,
    pub fortran: bool,
    pub dims: Vec<usize>,
    pub values: Vec<f64>,
}

impl Array {
    pub fn new(descr: &str, dims: &[usize], values: Vec<f64>) -> Self {
        assert_eq!(values.len(), dims.iter().product::<usize>());
        Self { descr: descr.to_owned(), fortran: false, dims: dims.to_vec(), values }
    }

    /// Of these few values.
    pub fn of(descr: &str, dims: &[usize], values: &[f64]) -> Self {
        Self::new(descr, dims, values.to_vec())
    }

    /// Values 1, 2, 3, ... in C order.
    pub fn counting(descr: &str, dims: &[usize]) -> Self {
        let count = dims.iter().product();
        let values: Vec<_> = (1..=count).map(|value: usize| value as f64).collect();
        Self::new(descr, dims, values)
    }

    pub fn filled(descr: &str, dims: &[usize], value: f64) -> Self {
        Self::new(descr, dims, vec![value; dims.iter().product()])
    }

    /// The same values in another element type.
    pub fn to(&self, descr: &str) -> Self {
        Self { descr: descr.to_owned(), ..self.clone() }
    }

    pub fn times(&self, factor: f64) -> Self {
        Self { values: self.values.iter().map(|value| value * factor).collect(), ..self.clone() }
    }

    pub fn fortran(&self) -> Self {
        Self { fortran: true, ..self.clone() }
    }

    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = header(&self.descr, self.fortran, &self.dims);
        for at in 0..self.values.len() {
            let at = if self.fortran { self.c_position(at) } else { at };
            bytes.extend(encode(&self.descr, self.values[at]));
        }
        bytes
    }

    /// Where in C order the value stands that comes at `at` in Fortran order.
    fn c_position(&self, at: usize) -> usize {
        let (mut rest, mut position, mut stride) = (at, 0, self.values.len());
        for dim in &self.dims {
            stride /= dim;
            position += rest % dim * stride;
            rest /= dim;
        }
        position
    }
}

pub fn header(descr: &str, fortran: bool, dims: &[usize]) -> Vec<u8> {
    let shape: String = dims.iter().map(|dim| format!("{dim},")).collect();
    let fortran = if fortran { "True" } else { "False" };
    let text = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': ({shape}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes
}

/// Header text and data of a version 1.0 file.
pub fn split(bytes: &[u8]) -> (String, Vec<u8>) {
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let data = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    (String::from_utf8(bytes[10..data].to_vec()).unwrap(), bytes[data..].to_vec())
}

fn encode(descr: &str, value: f64) -> Vec<u8> {
    let little = match &descr[1..] {
        "b1" => vec![u8::from(value != 0.0)],
        "u1" => (value as u8).to_le_bytes().to_vec(),
        "u2" => (value as u16).to_le_bytes().to_vec(),
        "u4" => (value as u32).to_le_bytes().to_vec(),
        "u8" => (value as u64).to_le_bytes().to_vec(),
        "i1" => (value as i8).to_le_bytes().to_vec(),
        "i2" => (value as i16).to_le_bytes().to_vec(),
        "i4" => (value as i32).to_le_bytes().to_vec(),
        "i8" => (value as i64).to_le_bytes().to_vec(),
        "f4" => (value as f32).to_le_bytes().to_vec(),
        "f8" => value.to_le_bytes().to_vec(),
        other => panic!("no encoding for {other}"),
    };
    if descr.starts_with('>') { little.into_iter().rev().collect() } else { little }
}
