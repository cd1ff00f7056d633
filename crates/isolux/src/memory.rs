//! The size of working memory, in bytes.

/// Bytes that a vector has allocated, used or not.
pub(crate) fn bytes<T>(values: &Vec<T>) -> usize {
    values.capacity() * size_of::<T>()
}
