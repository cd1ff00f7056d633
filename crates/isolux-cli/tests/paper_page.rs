//! The page of `isolux paper`: the same seed gives the same bytes, every figure is there, and a browser shows them. Ignored
//! by default, because it takes minutes without optimization:
//! `cargo test --release -p isolux-cli --test paper_page -- --ignored`.

#![expect(clippy::expect_used, reason = "a test that cannot run must stop")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{fs, str};

/// Every file below `folder`, with its path inside it.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let inside = path.strip_prefix(folder).expect("below the folder").to_owned();
                found.push((inside, fs::read(&path).expect("a file")));
            }
        }
    }
    found.sort();
    found
}

fn paper(output: &Path) -> String {
    let run = Command::new(env!("CARGO_BIN_EXE_isolux")).arg("paper").arg("-o").arg(output).output();
    let run = run.expect("the program starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    String::from_utf8(run.stdout).expect("UTF-8")
}

/// Numbers of the paper's figures that a document shows: `<figure … id="fig-N…">`.
fn figure_numbers(document: &str) -> BTreeSet<u32> {
    let figures = document.split("<figure").skip(1);
    let ids = figures.filter_map(|figure| figure.split(" id=\"fig-").nth(1));
    ids.filter_map(|id| id.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()).collect()
}

/// The document as a headless browser has it after loading; `None` where there is no browser.
fn opened_in_a_browser(page: &Path, profile: &Path) -> Option<String> {
    let browser = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg("--dump-dom")
        .arg(format!("file://{}", page.display()))
        .stderr(Stdio::null())
        .output();
    let dump = browser.ok()?;
    assert!(dump.status.success(), "the browser opens the page");
    Some(String::from_utf8_lossy(&dump.stdout).into_owned())
}

#[test]
#[ignore = "takes minutes without optimization"]
fn every_figure_is_there_and_the_same_seed_gives_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (first, second) = (folder.path().join("first"), folder.path().join("second"));
    let (printed, again) = (paper(&first), paper(&second));
    let verdicts = |printed: &str| printed.lines().filter(|line| !line.starts_with("written")).count();
    assert!(verdicts(&printed) > 20 && verdicts(&printed) == verdicts(&again));
    let (files, others) = (files(&first), files(&second));
    assert!(files == others, "the same seed gives the same bytes");
    assert!(files.iter().filter(|(path, _)| path.starts_with("data")).count() >= 13);

    let page = first.join("index.html");
    let text = fs::read_to_string(&page).expect("the page");
    let all: BTreeSet<u32> = (1..=13).collect();
    assert_eq!(figure_numbers(&text), all);
    match opened_in_a_browser(&page, &folder.path().join("profile")) {
        Some(document) => {
            assert_eq!(figure_numbers(&document), all);
            // The script has run: tables that can be sorted have buttons in their headings.
            assert!(document.matches("<th").count() > 20 && document.contains("</html>"));
        }
        None => println!("skipped: no chromium, the page was not opened in a browser"),
    }
}
