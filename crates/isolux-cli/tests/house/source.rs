//! A source file as a list of tokens, without comments and without what is compiled for tests only.

use std::collections::BTreeSet;
use std::iter::Peekable;
use std::vec::IntoIter;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// A token; groups are written out with their brackets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Token {
    Word(String),
    /// The content of a string literal, as it stands in the file.
    Text(String),
    Mark(char),
}

/// A source file.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    /// Below `crates/`.
    pub(crate) path: String,
    /// With their lines.
    pub(crate) tokens: Vec<(Token, usize)>,
    /// Modules in files of their own that are declared for tests only.
    pub(crate) test_modules: BTreeSet<String>,
}

impl Source {
    pub(crate) fn read(path: &str, text: &str) -> Self {
        let stream: TokenStream = text.parse().unwrap_or_else(|error| panic!("{path}: {error}"));
        let mut source = Self { path: path.to_owned(), tokens: Vec::new(), test_modules: BTreeSet::new() };
        source.add(stream);
        source
    }

    fn add(&mut self, stream: TokenStream) {
        let mut trees = stream.into_iter().collect::<Vec<_>>().into_iter().peekable();
        while let Some(tree) = trees.next() {
            let line = tree.span().start().line;
            match tree {
                TokenTree::Punct(mark) if mark.as_char() == '#' => match attribute(&mut trees) {
                    Some(content) if is_for_tests(&content) => self.skip_item(&mut trees),
                    Some(content) if !is_doc(&content) => self.add(content),
                    Some(_) => {}
                    None => self.tokens.push((Token::Mark('#'), line)),
                },
                TokenTree::Punct(mark) => self.tokens.push((Token::Mark(mark.as_char()), line)),
                TokenTree::Ident(word) => self.tokens.push((Token::Word(word.to_string()), line)),
                TokenTree::Literal(literal) => {
                    let text = literal.to_string();
                    // A character may be the mark itself, alone.
                    if let (Some(from), Some(to)) = (text.find('"'), text.rfind('"'))
                        && from < to
                    {
                        self.tokens.push((Token::Text(text[from + 1..to].to_owned()), line));
                    }
                }
                TokenTree::Group(group) => {
                    let (open, close) = match group.delimiter() {
                        Delimiter::Parenthesis => ('(', ')'),
                        Delimiter::Brace => ('{', '}'),
                        Delimiter::Bracket => ('[', ']'),
                        Delimiter::None => (' ', ' '),
                    };
                    self.tokens.push((Token::Mark(open), line));
                    self.add(group.stream());
                    self.tokens.push((Token::Mark(close), group.span_close().start().line));
                }
            }
        }
    }

    /// Leaves out everything up to the item's end: its body or its semicolon.
    fn skip_item(&mut self, trees: &mut Peekable<IntoIter<TokenTree>>) {
        let mut before = String::new();
        for tree in trees.by_ref() {
            match tree {
                TokenTree::Punct(mark) if mark.as_char() == ';' => return,
                TokenTree::Group(group) if group.delimiter() == Delimiter::Brace && before != "use" => return,
                TokenTree::Ident(word) => {
                    let declared = before == "mod";
                    // A `use` has braces before its semicolon.
                    if before != "use" {
                        before = word.to_string();
                    }
                    if declared {
                        self.test_modules.insert(word.to_string());
                    }
                }
                _ => {}
            }
        }
    }
}

/// The content of an attribute whose `#` has been read.
fn attribute(trees: &mut Peekable<IntoIter<TokenTree>>) -> Option<TokenStream> {
    trees.next_if(|tree| matches!(tree, TokenTree::Punct(mark) if mark.as_char() == '!'));
    let bracket =
        |tree: &TokenTree| matches!(tree, TokenTree::Group(g) if g.delimiter() == Delimiter::Bracket);
    match trees.next_if(bracket)? {
        TokenTree::Group(group) => Some(group.stream()),
        _ => None,
    }
}

fn is_for_tests(attribute: &TokenStream) -> bool {
    attribute.to_string().replace(' ', "") == "cfg(test)"
}

fn is_doc(attribute: &TokenStream) -> bool {
    attribute.to_string().starts_with("doc")
}

#[test]
fn comments_documents_and_tests_are_left_out() {
    let text = r##"
        //! "one"
        /// "two"
        #[error("three")]
        fn f() { /* "four" */ g("five", r#"six "quoted""#); }
        #[cfg(test)]
        use a::{b, c};
        #[cfg(test)]
        #[allow(dead_code)]
        mod tests { const A: &str = "seven"; }
        #[cfg(test)]
        mod elsewhere;
        const B: &str = "eight"; const C: char = '"';
    "##;
    let source = Source::read("x.rs", text);
    let texts: Vec<(&str, usize)> = (source.tokens.iter())
        .filter_map(|(token, line)| match token {
            Token::Text(text) => Some((text.as_str(), *line)),
            _ => None,
        })
        .collect();
    assert_eq!(texts, [("three", 4), ("five", 5), ("six \"quoted\"", 5), ("eight", 13)]);
    assert!(source.test_modules.contains("elsewhere"));
    assert!(!source.tokens.contains(&(Token::Word("b".to_owned()), 7)));
}
