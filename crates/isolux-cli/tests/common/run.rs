//! What became of a command.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Stdio};

/// A finished command.
#[derive(Debug)]
pub struct Run {
    what: String,
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    pub fn new(mut command: Command) -> Self {
        let words: Vec<_> = command.get_args().map(|word| word.to_string_lossy().into_owned()).collect();
        let output = command.stdin(Stdio::null()).output().unwrap();
        let run = Self {
            what: format!("isolux {}", words.join(" ")),
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        };
        assert!(!run.stderr.contains("panicked") && run.code.is_some(), "{run:#?}");
        run
    }

    /// Lines on stderr that are no remarks.
    fn complaints(&self) -> Vec<&str> {
        let remark = |line: &&str| line.starts_with("note: ") || line.starts_with("warning: ");
        self.stderr.lines().filter(|line| !remark(line)).collect()
    }

    /// Fails unless the command was done, without a complaint.
    pub fn done(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:#?}");
        assert!(self.complaints().is_empty(), "{self:#?}");
        self
    }

    /// The result of a command that prints JSON.
    pub fn json(self) -> serde_json::Value {
        let run = self.done();
        serde_json::from_str(&run.stdout).unwrap_or_else(|error| panic!("{error}: {run:#?}"))
    }

    /// Fails unless the command ended with `code`, nothing on stdout, and one message that holds every part. The
    /// parser of the command line adds advice below its message.
    pub fn refused(self, code: i32, parts: &[&str]) -> Self {
        assert_eq!(self.code, Some(code), "{self:#?}");
        assert_eq!(self.stdout, "", "{self:#?}");
        let complaints = self.complaints();
        let parsed = code == 2 && self.stderr.contains("For more information, try");
        assert!(complaints[0].starts_with("error: "), "{self:#?}");
        assert!(parsed || complaints.len() == 1, "{self:#?}");
        for part in parts {
            assert!(self.stderr.contains(part), "{}: no \"{part}\" in: {}", self.what, self.stderr);
        }
        self
    }

    /// Fails unless stderr holds this remark.
    pub fn remarks(self, part: &str) -> Self {
        assert!(self.stderr.contains(part), "{self:#?}");
        self
    }

    pub fn prints(self, part: &str) -> Self {
        assert!(self.stdout.contains(part), "no \"{part}\" in {self:#?}");
        self
    }
}

/// Runs the program, which must succeed, whatever it remarks; returns what it printed.
pub fn run(args: &[&dyn AsRef<OsStr>]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_isolux"));
    command.args(args.iter().map(|arg| arg.as_ref()));
    let run = Run::new(command);
    assert_eq!(run.code, Some(0), "{run:#?}");
    run.stdout
}

/// Simulates a scene into `folder`/`name` with the program.
pub fn simulate(folder: &Path, scene: &str) {
    run(&[&"simulate", &scene, &"-o", &folder.join(scene)]);
}
