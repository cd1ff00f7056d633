//! The members of an `.npz`: a ZIP archive of `.npy` files, stored or deflated.

use std::fs::File;
use std::path::Path;

use zip::{CompressionMethod, ZipArchive};

use super::channel::ArrayFile;
use super::stream::{Packing, Section};
use crate::error::RecordingError;

/// Deflate codes at most 258 bytes in 2 bits, so that no undamaged member grows by more than this.
const MOST_DEFLATE_GROWTH: u64 = 1032;

/// Opens every array of an archive and reads its header. Members in folders are left alone.
pub(crate) fn open_arrays(path: &Path) -> Result<Vec<ArrayFile>, RecordingError> {
    let metadata = std::fs::metadata(path).map_err(RecordingError::io("open", path))?;
    if !metadata.is_file() {
        return Err(RecordingError::content(path, "a folder or device", "a .npz file"));
    }
    let file = File::open(path).map_err(RecordingError::io("open", path))?;
    if metadata.len() == 0 {
        return Err(RecordingError::content(path, "an empty file", "a .npz archive"));
    }
    let mut archive = ZipArchive::new(file).map_err(|error| damaged(path, &error))?;
    if archive.has_duplicate_names() {
        return Err(RecordingError::content(path, "two members of one name", "each name once"));
    }
    let mut arrays = Vec::new();
    for index in 0..archive.len() {
        if let Some((name, section)) = member(&mut archive, index, path, metadata.len())? {
            let file = File::open(path).map_err(RecordingError::io("open", path))?;
            let member_path = path.join(format!("{name}.npy"));
            arrays.push(ArrayFile::open(name, member_path, file, section)?);
        }
    }
    arrays.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(arrays)
}

/// Channel name and place of a member; `None` for what is no channel.
fn member(
    archive: &mut ZipArchive<File>,
    index: usize,
    path: &Path,
    file_bytes: u64,
) -> Result<Option<(String, Section)>, RecordingError> {
    let member = archive.by_index_raw(index).map_err(|error| damaged(path, &error))?;
    let name = member.name().map_err(|error| damaged(path, &error))?.into_owned();
    let Some(channel) = name.strip_suffix(".npy").filter(|name| !name.contains(['/', '\\'])) else {
        return Ok(None);
    };
    let member_path = path.join(&name);
    if member.encrypted() {
        return Err(RecordingError::content(&member_path, "an encrypted member", "a plain one"));
    }
    let packing = match member.compression() {
        CompressionMethod::Stored => Packing::Plain,
        CompressionMethod::Deflated => Packing::Deflate { crc32: member.crc32() },
        other => {
            let found = format!("a member compressed by {other}");
            let expected = "stored or deflated, as numpy.savez and numpy.savez_compressed write it";
            return Err(RecordingError::content(&member_path, found, expected));
        }
    };
    let (stored_bytes, bytes) = (member.compressed_size(), member.size());
    let most = match packing {
        Packing::Plain => stored_bytes,
        Packing::Deflate { .. } => stored_bytes.saturating_mul(MOST_DEFLATE_GROWTH),
    };
    let start = member.data_start().unwrap_or(u64::MAX);
    let inside = start.checked_add(stored_bytes).is_some_and(|end| end <= file_bytes);
    if !inside || bytes > most {
        let found = format!("a member of {bytes} bytes from {stored_bytes} in the archive");
        let expected = format!("no more than the archive's {file_bytes} bytes can hold");
        return Err(RecordingError::content(&member_path, found, expected));
    }
    Ok(Some((channel.to_owned(), Section { start, stored_bytes, bytes, packing })))
}

fn damaged(path: &Path, error: &zip::result::ZipError) -> RecordingError {
    RecordingError::content(path, format!("damaged data ({error})"), "a .npz archive")
}
