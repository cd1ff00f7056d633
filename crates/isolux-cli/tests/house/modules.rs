//! The modules of a crate, what each imports and mentions, and which module a path leads to.

use std::collections::BTreeMap;

use super::source::{Source, Token};

/// The names of a module, from the crate's root on; empty for the root.
pub(crate) type Path = Vec<String>;

/// A path that a module writes down.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Mention {
    pub(crate) names: Path,
    pub(crate) line: usize,
    /// Handed on by `pub use`.
    pub(crate) is_export: bool,
}

/// A module: one file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Module {
    /// Below `crates/`.
    pub(crate) file: String,
    /// What `use` brings in, by the name that it has here.
    imports: BTreeMap<String, Path>,
    pub(crate) mentions: Vec<Mention>,
}

/// All modules of a crate, without those for tests.
#[derive(Clone, Debug)]
pub(crate) struct Crate(pub(crate) BTreeMap<Path, Module>);

impl Crate {
    /// `name` is the crate's folder; the paths of `sources` begin with it.
    pub(crate) fn new(name: &str, sources: Vec<Source>) -> Self {
        let of_file = |file: &str| -> Path {
            let below = file.trim_start_matches(name).trim_start_matches("/src/").trim_end_matches(".rs");
            let names = below.split('/').filter(|name| !["mod", "lib", "main"].contains(name));
            names.map(str::to_owned).collect()
        };
        let mut for_tests = Vec::new();
        let mut modules = BTreeMap::new();
        for source in sources {
            let path = of_file(&source.path);
            let child = |name: &String| [path.clone(), vec![name.clone()]].concat();
            for_tests.extend(source.test_modules.iter().map(child));
            modules.insert(path, Module::read(&source));
        }
        modules.retain(|path, _| !for_tests.iter().any(|tests| path.starts_with(tests)));
        Self(modules)
    }

    /// The module that defines what the path names, as seen from `from`; `None` for other crates and for a path that
    /// names a module itself, which is used only where something in it is.
    pub(crate) fn target(&self, from: &[String], names: &[String]) -> Option<Path> {
        self.walk(from, names, 0)
    }

    fn walk(&self, from: &[String], names: &[String], depth: usize) -> Option<Path> {
        // An import of another crate's name leads to itself.
        if depth > 16 {
            return None;
        }
        let first = names.first()?;
        let mut at = from.to_vec();
        let mut rest = &names[1..];
        match first.as_str() {
            "crate" => at.clear(),
            "self" => {}
            "super" => {
                at.pop();
                while let Some((_, after)) = rest.split_first().filter(|(name, _)| *name == "super") {
                    at.pop();
                    rest = after;
                }
            }
            name if self.child(&at, name).is_some() => at.push(name.to_owned()),
            name => {
                let import = self.0.get(from)?.imports.get(name)?;
                return self.walk(from, &[import, rest].concat(), depth + 1);
            }
        }
        while let Some((name, after)) = rest.split_first() {
            let import = self.0.get(&at).and_then(|module| module.imports.get(name));
            match (self.child(&at, name), import) {
                // A function may be handed on under the name of its module.
                (Some(child), None) => at = child,
                (Some(child), Some(_)) if !after.is_empty() => at = child,
                (_, Some(import)) => {
                    let import = [import, after].concat();
                    return self.walk(&at, &import, depth + 1);
                }
                (None, None) => return Some(at),
            }
            rest = after;
        }
        None
    }

    fn child(&self, parent: &[String], name: &str) -> Option<Path> {
        let child = [parent, &[name.to_owned()]].concat();
        self.0.contains_key(&child).then_some(child)
    }
}

impl Module {
    fn read(source: &Source) -> Self {
        let mut module = Self { file: source.path.clone(), ..Self::default() };
        let mut reader = Reader { tokens: &source.tokens, at: 0 };
        while let Some((token, line)) = reader.tokens.get(reader.at) {
            match token {
                Token::Word(word) if word == "use" && reader.mark(1) != Some('<') => {
                    let is_export = reader.is_public();
                    reader.at += 1;
                    reader.tree(&mut Vec::new(), &mut |names, alias| {
                        module.imports.insert(alias, names.clone());
                        module.mentions.push(Mention { names, line: *line, is_export });
                    });
                }
                Token::Word(_) => {
                    let names = reader.path();
                    if names.len() > 1 {
                        module.mentions.push(Mention { names, line: *line, is_export: false });
                    }
                }
                _ => reader.at += 1,
            }
        }
        module
    }
}

struct Reader<'a> {
    tokens: &'a [(Token, usize)],
    at: usize,
}

impl Reader<'_> {
    fn mark(&self, ahead: usize) -> Option<char> {
        match self.tokens.get(self.at + ahead) {
            Some((Token::Mark(mark), _)) => Some(*mark),
            _ => None,
        }
    }

    fn word(&self, ahead: usize) -> Option<&str> {
        match self.tokens.get(self.at + ahead) {
            Some((Token::Word(word), _)) => Some(word),
            _ => None,
        }
    }

    /// Whether `pub` or `pub(…)` stands before this.
    fn is_public(&self) -> bool {
        let is = |token: Option<&(Token, usize)>, word: &str| matches!(token, Some((Token::Word(found), _)) if found == word);
        let before = &self.tokens[..self.at];
        let closed = matches!(before.last(), Some((Token::Mark(')'), _)));
        let open = before.iter().rposition(|(token, _)| *token == Token::Mark('('));
        match open {
            Some(open) if closed => is(before[..open].last(), "pub"),
            _ => is(before.last(), "pub"),
        }
    }

    /// Words with `::` between them; at least one token is passed.
    fn path(&mut self) -> Path {
        let mut names = Vec::new();
        while let Some(word) = self.word(0) {
            names.push(word.to_owned());
            self.at += 1;
            if !(self.mark(0) == Some(':') && self.mark(1) == Some(':') && self.word(2).is_some()) {
                break;
            }
            self.at += 2;
        }
        names
    }

    /// One branch of a `use`: tells every name that it ends in, with what it is called here.
    fn tree(&mut self, before: &mut Path, tell: &mut dyn FnMut(Path, String)) {
        let depth = before.len();
        loop {
            match self.tokens.get(self.at) {
                Some((Token::Word(word), _)) if word != "as" => {
                    before.push(word.clone());
                    self.at += 1;
                }
                Some((Token::Mark(':'), _)) => self.at += 1,
                Some((Token::Mark('{'), _)) => {
                    self.at += 1;
                    while self.mark(0) != Some('}') && self.at < self.tokens.len() {
                        self.tree(before, tell);
                        if self.mark(0) == Some(',') {
                            self.at += 1;
                        }
                    }
                    self.at += 1;
                    before.truncate(depth);
                    return;
                }
                _ => break,
            }
        }
        let mut names = before.clone();
        if names.last().is_some_and(|name| name == "self") && names.len() > 1 {
            names.pop();
        }
        if self.mark(0) == Some('*') {
            self.at += 1;
            names.push("*".to_owned());
        }
        let mut alias = names.last().cloned().unwrap_or_default();
        if self.word(0) == Some("as") {
            alias = self.word(1).unwrap_or_default().to_owned();
            self.at += 2;
        }
        tell(names, alias);
        before.truncate(depth);
    }
}
