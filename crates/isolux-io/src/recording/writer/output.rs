//! Where a recording is written: under a temporary name beside the output, so that it appears whole or not at all.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::error::RecordingError;

/// The output and the folder that it is prepared in.
#[derive(Debug)]
pub(super) struct Output {
    path: PathBuf,
    archive: bool,
    overwrite: bool,
    /// Removed when it is dropped, unless it has been renamed to be the output.
    staging: TempDir,
}

impl Output {
    pub(super) fn create(path: &Path, overwrite: bool) -> Result<Self, RecordingError> {
        if path.file_name().is_none() {
            return Err(RecordingError::write(
                path,
                "a path without a name",
                "a folder or .npz file to create",
            ));
        }
        let archive = path.extension().is_some_and(|extension| extension == "npz");
        check_target(path, archive, overwrite)?;
        let staging = folder_beside(path).map_err(RecordingError::io("create", path))?;
        Ok(Self { path: path.to_owned(), archive, overwrite, staging })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The folder for the channels' files.
    pub(super) fn staging(&self) -> &Path {
        self.staging.path()
    }

    /// Completes the recording from the staged channels and gives it its name.
    pub(super) fn publish(self, channels: &[String], json: &str) -> Result<(), RecordingError> {
        let folder = self.staging.path();
        let json_path = folder.join("recording.json");
        fs::write(&json_path, json).map_err(RecordingError::io("write", &json_path))?;
        if !self.archive {
            check_target(&self.path, false, self.overwrite)?;
            return replace(folder, &self.path);
        }
        let archive_path = folder.join("recording.npz");
        pack(folder, channels, &archive_path)?;
        check_target(&self.path, true, self.overwrite)?;
        let json_target = self.path.with_extension("json");
        let json_existed = json_target.exists();
        // The archive last: it is what makes the recording be there.
        fs::rename(&json_path, &json_target).map_err(RecordingError::io("create", &json_target))?;
        fs::rename(&archive_path, &self.path).map_err(|error| {
            if !json_existed {
                let _ = fs::remove_file(&json_target);
            }
            RecordingError::io("create", &self.path)(error)
        })
    }
}

/// A folder with a hidden name in the same folder, so that a rename stays within one file system; with the
/// permissions that the user's umask grants.
fn folder_beside(path: &Path) -> io::Result<TempDir> {
    let mut prefix = std::ffi::OsString::from(".");
    prefix.push(path.file_name().unwrap_or_default());
    prefix.push(".partial-");
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // Checked first, so that the error about a missing folder does not name a hidden file in it.
    fs::metadata(folder)?;
    tempfile::Builder::new().prefix(&prefix).tempdir_in(folder)
}

/// Refuses an output that is there, unless it is a recording that may be overwritten.
fn check_target(path: &Path, archive: bool, overwrite: bool) -> Result<(), RecordingError> {
    let json = path.with_extension("json");
    let targets = if archive { vec![path, json.as_path()] } else { vec![path] };
    for target in targets {
        let Ok(metadata) = fs::symlink_metadata(target) else { continue };
        if !overwrite {
            return Err(RecordingError::Exists { path: target.to_owned() });
        }
        let not =
            |found: &str| RecordingError::NotReplaced { path: target.to_owned(), found: found.to_owned() };
        if archive && !metadata.is_file() {
            return Err(not("a folder, link or device"));
        }
        if archive && !path.exists() {
            return Err(not("JSON without the .npz it would describe"));
        }
        if !archive {
            if !metadata.is_dir() {
                return Err(not("a file"));
            }
            if let Some(foreign) = foreign_entry(target)? {
                return Err(not(&format!("`{foreign}`")));
            }
        }
    }
    Ok(())
}

/// The first entry of a folder that is no part of a recording.
fn foreign_entry(folder: &Path) -> Result<Option<String>, RecordingError> {
    for entry in fs::read_dir(folder).map_err(RecordingError::io("list", folder))? {
        let entry = entry.map_err(RecordingError::io("list", folder))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if !is_file || !(name.ends_with(".npy") || name == "recording.json" || name == "recording.npz") {
            return Ok(Some(name));
        }
    }
    Ok(None)
}

/// Renames `folder` to `path`. What was there is moved aside first, put back on failure, removed on success.
fn replace(folder: &Path, path: &Path) -> Result<(), RecordingError> {
    let create = || RecordingError::io("create", path);
    if !path.exists() {
        return fs::rename(folder, path).map_err(create());
    }
    let aside = folder_beside(path).map_err(RecordingError::io("replace", path))?;
    let old = aside.path().join("replaced");
    fs::rename(path, &old).map_err(RecordingError::io("replace", path))?;
    if let Err(error) = fs::rename(folder, path) {
        if fs::rename(&old, path).is_err() {
            // If this fails, the old recording must not be removed with the folder that it is in.
            let _ = aside.keep();
        }
        return Err(create()(error));
    }
    fs::remove_dir_all(&old).map_err(RecordingError::io("remove", &old))
}

/// Packs the channels' files into a ZIP archive, stored, and removes each as soon as it is packed. The time
/// stamps are fixed: same input, same output.
fn pack(folder: &Path, channels: &[String], archive: &Path) -> Result<(), RecordingError> {
    let file = File::create_new(archive).map_err(RecordingError::io("create", archive))?;
    let zip_error = |error: zip::result::ZipError| RecordingError::io("write", archive)(error.into());
    let mut zip = ZipWriter::new(io::BufWriter::with_capacity(1 << 20, file));
    for channel in channels {
        let name = format!("{channel}.npy");
        let path = folder.join(&name);
        let mut source = File::open(&path).map_err(RecordingError::io("open", &path))?;
        let bytes = source.metadata().map_err(RecordingError::io("look at", &path))?.len();
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(zip::DateTime::default())
            .large_file(bytes >= u64::from(u32::MAX));
        zip.start_file(name, options).map_err(zip_error)?;
        io::copy(&mut source, &mut zip).map_err(RecordingError::io("write", archive))?;
        fs::remove_file(&path).map_err(RecordingError::io("remove", &path))?;
    }
    let mut writer = zip.finish().map_err(zip_error)?;
    io::Write::flush(&mut writer).map_err(RecordingError::io("write", archive))
}
