//! What working memory costs.

/// Bytes that a vector holds, filled or not.
pub(crate) fn bytes<T>(values: &Vec<T>) -> usize {
    values.capacity() * size_of::<T>()
}
