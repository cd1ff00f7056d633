//! A report on disk: the page, the numbers of its figures, its pictures.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::csv::{chart_csv, table_csv};
use crate::error::ReportError;
use crate::page::{Block, Page};
use crate::png;
use crate::render::render;

/// Folder of the CSV files, beside the page.
const DATA: &str = "data";
/// Folder of the PNG files, beside the page.
const PICTURES: &str = "pictures";

/// Writes a page as `folder/file_name`, with `data/ID.csv` for each chart and table and `pictures/ID.png` for each
/// picture beside it.
///
/// A `folder` that does not exist appears whole or not at all. In one that exists, other files stay as they are;
/// all files are complete before the first takes its place, and the page comes last; when one cannot be placed,
/// those that are new are taken away again.
///
/// # Errors
/// As [`render`], and [`ReportError::FileName`] or [`ReportError::Write`] when the files cannot be written.
pub fn write_report(page: &Page, folder: &Path, file_name: &str) -> Result<PathBuf, ReportError> {
    let files = files(page, file_name)?;
    // The empty path of `Path::parent` means the current folder.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| ReportError::Write { path, source }
    };
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let exists = folder.is_dir();
    let near = if exists { folder } else { parent };
    fs::create_dir_all(near).map_err(failed(near))?;
    let draft = draft_folder(near).map_err(failed(near))?;
    for (name, bytes) in &files {
        let path = draft.path().join(name);
        put_file(&path, bytes).map_err(failed(&path))?;
    }
    if exists {
        place(draft.path(), folder, &files)?;
    } else {
        fs::rename(draft.path(), folder).map_err(failed(folder))?;
        // The folder is no draft any more: nothing is left to remove.
        let _ = draft.keep();
    }
    Ok(folder.join(file_name))
}

type File = (PathBuf, Vec<u8>);

/// All files with their paths inside the folder, the page last.
fn files(page: &Page, file_name: &str) -> Result<Vec<File>, ReportError> {
    let plain = Path::new(file_name).file_name().is_some_and(|name| name == file_name);
    if !plain || [DATA, PICTURES].contains(&file_name) {
        return Err(ReportError::FileName { found: file_name.to_owned() });
    }
    let html = render(page)?;
    let csv = |id: &str, text: String| (Path::new(DATA).join(format!("{id}.csv")), text.into_bytes());
    let mut files = Vec::new();
    for block in page.sections.iter().flat_map(|section| &section.blocks) {
        match block {
            Block::Chart(chart) => files.push(csv(&chart.id, chart_csv(chart))),
            Block::Table(table) => files.push(csv(&table.id, table_csv(table))),
            Block::Pictures(pictures) => {
                for picture in pictures {
                    let path = Path::new(PICTURES).join(format!("{}.png", picture.id));
                    files.push((path, png::encode(picture)?));
                }
            }
            Block::Text(_) | Block::Quote { .. } | Block::Claims(_) => {}
        }
    }
    files.push((PathBuf::from(file_name), html.into_bytes()));
    Ok(files)
}

fn draft_folder(near: &Path) -> io::Result<tempfile::TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".isolux-");
    // The usual permissions of a new folder, not the private ones of a temporary one.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    builder.tempdir_in(near)
}

fn put_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(path, bytes)
}

/// Moves complete files to their places; takes the new ones away again when one fails.
fn place(draft: &Path, folder: &Path, files: &[File]) -> Result<(), ReportError> {
    let mut new: Vec<PathBuf> = Vec::new();
    for (name, _) in files {
        let path = folder.join(name);
        let is_new = !path.exists();
        let placed = path
            .parent()
            .map_or(Ok(()), fs::create_dir_all)
            .and_then(|()| fs::rename(draft.join(name), &path));
        if let Err(source) = placed {
            for path in new {
                // The first error is the one to report.
                let _ = fs::remove_file(path);
            }
            // Folders that others use are not empty and stay.
            for made in [DATA, PICTURES] {
                let _ = fs::remove_dir(folder.join(made));
            }
            return Err(ReportError::Write { path, source });
        }
        if is_new {
            new.push(path);
        }
    }
    Ok(())
}
