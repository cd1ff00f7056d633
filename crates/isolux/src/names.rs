//! Names of steps, rules and tiers. Each name is defined once, in the code of what it names; the command line,
//! files, Python and the documents take it from there. This module holds the error about an unknown name and what
//! the types with names share.

/// A text that is none of the expected names.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what} `{found}` found, {} expected", one_of(expected))]
pub struct UnknownName {
    /// What should be named, such as `time step` or `response tier`.
    pub what: &'static str,
    /// The text found.
    pub found: String,
    /// The names there are.
    pub expected: Vec<&'static str>,
}

impl UnknownName {
    /// None of `names`, where one of them was expected.
    pub(crate) fn new(what: &'static str, found: &str, names: &[&'static str]) -> Self {
        Self { what, found: found.to_owned(), expected: names.to_vec() }
    }

    /// Where another name would have done as well.
    pub(crate) fn or(mut self, name: &'static str) -> Self {
        self.expected.push(name);
        self
    }
}

/// `a, b or c`.
pub(crate) fn one_of(names: &[&str]) -> String {
    match names {
        [] => "nothing".to_owned(),
        [only] => (*only).to_owned(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

/// Declares an enum of plain variants, each with its name and a description (one line of documentation). It gets
/// `ALL`, `NAMES`, `name`, `description`, `FromStr`, `Display`, and serde by name.
macro_rules! named {
    (
        $(#[$outer:meta])*
        pub enum $type:ident: $what:literal {
            $( #[doc = $doc:literal] $(#[$rest:ident])? $variant:ident = $name:literal, )+
        }
    ) => {
        $(#[$outer])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $type {
            $( #[doc = $doc] $(#[$rest])? $variant, )+
        }

        impl $type {
            /// All values.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];
            /// Their names, in the same order.
            pub const NAMES: &'static [&'static str] = &[$($name),+];

            /// Its name in files, on the command line and in Python.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)+ }
            }

            /// What it is, in a few words.
            #[must_use]
            pub fn description(self) -> &'static str {
                match self { $(Self::$variant => $doc.trim(),)+ }
            }
        }

        $crate::names::by_name!($type);

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::names::UnknownName;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                let named = Self::ALL.iter().find(|one| one.name() == text);
                named.copied().ok_or_else(|| $crate::names::UnknownName::new($what, text, Self::NAMES))
            }
        }
    };
}

/// Serde by the text that `Display` writes and `FromStr` reads.
macro_rules! by_name {
    ($type:ident) => {
        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let text = <std::borrow::Cow<'_, str>>::deserialize(deserializer)?;
                text.parse().map_err(serde::de::Error::custom)
            }
        }
    };
}

pub(crate) use {by_name, named};

#[cfg(test)]
mod tests {
    use crate::step_names::{Method, TimeStep};

    #[test]
    fn a_name_reads_back_as_what_it_names() {
        for (step, name) in TimeStep::ALL.iter().zip(TimeStep::NAMES) {
            assert_eq!((step.name(), name.parse()), (*name, Ok(*step)));
            let json = serde_json::to_string(step).unwrap();
            assert_eq!(
                (json.as_str(), serde_json::from_str(&json).ok()),
                (&*format!("{name:?}"), Some(*step))
            );
        }
        assert_eq!(TimeStep::Lut.description(), "The calibration's lookup table.");
        assert_eq!(format!("{:>5}", Method::default()), " best");
    }

    #[test]
    fn other_texts_are_told_the_names() {
        let error = "BEST".parse::<Method>().unwrap_err();
        assert_eq!(error.to_string(), "method `BEST` found, paper or best expected");
    }
}
