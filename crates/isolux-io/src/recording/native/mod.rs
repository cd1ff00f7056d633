//! The native format: a folder of `.npy` files, or one `.npz`.

mod archive;
mod channel;
mod find;
mod folder;
mod gathered;
mod mapped;
mod sequential;
mod shapes;
mod source;
mod stream;

pub(crate) use source::NativeSource;
