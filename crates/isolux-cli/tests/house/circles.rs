//! Which module uses which, and the circles among them.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::modules::Crate;
use super::source::Source;

/// For each file the files that it uses, with one use as proof.
#[derive(Clone, Debug, Default)]
pub(crate) struct Uses(BTreeMap<String, BTreeMap<String, String>>);

impl Uses {
    pub(crate) fn of(of: &Crate) -> Self {
        let mut uses = Self::default();
        for (path, module) in &of.0 {
            for mention in &module.mentions {
                let Some(target) = of.target(path, &mention.names) else { continue };
                // A list that hands on what is below it does not use it.
                let hands_on = mention.is_export && target.starts_with(path);
                let Some(used) = of.0.get(&target).filter(|_| target != *path && !hands_on) else { continue };
                let proof =
                    format!("crates/{}:{} uses {}", module.file, mention.line, mention.names.join("::"));
                let from = uses.0.entry(module.file.clone()).or_default();
                from.entry(used.file.clone()).or_insert(proof);
            }
        }
        uses
    }

    /// The shortest circle through each file that is in one, every circle once, file by file.
    pub(crate) fn circles(&self) -> Vec<String> {
        let mut seen = BTreeSet::new();
        let mut circles = Vec::new();
        for start in self.0.keys() {
            let Some(circle) = self.shortest(start) else { continue };
            let members: BTreeSet<&String> = circle.iter().copied().collect();
            if seen.insert(members) {
                let pairs = circle.iter().zip(circle.iter().cycle().skip(1));
                let arrows: Vec<String> =
                    pairs.map(|(from, to)| format!("{}\n    of crates/{to}", self.0[*from][*to])).collect();
                circles.push(arrows.join("\n"));
            }
        }
        circles
    }

    /// The files on the shortest way from `start` back to it.
    fn shortest<'a>(&'a self, start: &'a String) -> Option<Vec<&'a String>> {
        let mut came_from: BTreeMap<&String, &String> = BTreeMap::new();
        let mut queue = VecDeque::from([start]);
        while let Some(file) = queue.pop_front() {
            for next in self.0.get(file).into_iter().flat_map(BTreeMap::keys) {
                if next == start {
                    let mut circle = vec![file];
                    while let Some(before) = came_from.get(circle[circle.len() - 1]) {
                        circle.push(before);
                    }
                    circle.reverse();
                    return Some(circle);
                }
                if !came_from.contains_key(next) {
                    came_from.insert(next, file);
                    queue.push_back(next);
                }
            }
        }
        None
    }
}

/// The circles of a crate `a` of these files.
#[cfg(test)]
fn circles_of(files: &[(&str, &str)]) -> Vec<String> {
    let sources = files.iter().map(|(path, text)| Source::read(&format!("a/src/{path}"), text));
    Uses::of(&Crate::new("a", sources.collect())).circles()
}

#[test]
fn a_planted_circle_is_named_file_by_file() {
    let files = [
        ("lib.rs", "mod b;\nmod c;\nmod d;\npub use b::B;\n"),
        ("b.rs", "use crate::c::{self, other};\npub struct B;\nfn f() { c::g() }\n"),
        ("c/mod.rs", "pub mod e;\npub fn g() { super::d::h() }\n"),
        // The root hands `B` on: what is used is its module.
        ("d.rs", "pub fn h(b: crate::B) {}\n"),
        ("c/e.rs", "use std::fmt;\nuse crate::d::h as quite_another;\n"),
    ];
    let expected = "crates/a/src/b.rs:1 uses crate::c::other\n    of crates/a/src/c/mod.rs\n\
                    crates/a/src/c/mod.rs:2 uses super::d::h\n    of crates/a/src/d.rs\n\
                    crates/a/src/d.rs:1 uses crate::B\n    of crates/a/src/b.rs";
    assert_eq!(circles_of(&files), [expected]);
}

#[test]
fn a_child_that_uses_its_parent_is_a_circle_only_if_the_parent_uses_it() {
    let child = ("c/e.rs", "use super::Parent;\npub struct E;\n");
    let lists = ("c/mod.rs", "mod e;\npub use e::E;\npub struct Parent;\n");
    assert_eq!(circles_of(&[("lib.rs", "mod c;"), lists, child]), Vec::<String>::new());
    let uses = ("c/mod.rs", "mod e;\npub struct Parent(e::E);\n");
    assert_eq!(circles_of(&[("lib.rs", "mod c;"), uses, child]).len(), 1);
    // What the parent takes from a sibling is not the parent's.
    let takes = ("c/mod.rs", "mod e;\nmod s;\nuse s::Parent;\nfn f(e: e::E) {}\n");
    assert_eq!(circles_of(&[("lib.rs", "mod c;"), takes, child, ("c/s.rs", "")]), Vec::<String>::new());
}

#[test]
fn documents_tests_and_other_crates_make_no_circle() {
    let files = [
        ("lib.rs", "mod b;\nmod c;\n"),
        ("b.rs", "use crate::c::C;\n/// See [`crate::c`].\npub struct B;\n#[cfg(test)]\nmod tests;\n"),
        ("b/tests.rs", "use crate::c::C;\nuse super::B;\n"),
        (
            "c.rs",
            "use other::b::B;\n//! crate::b::B\n#[cfg(test)]\nmod tests { use crate::b::B; }\npub struct C;\n",
        ),
    ];
    assert_eq!(circles_of(&files), Vec::<String>::new());
}
