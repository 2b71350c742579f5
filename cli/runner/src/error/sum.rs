//! Errors that are one of several.

/// An enumeration of errors, each shown as it is and worth to the shell what it is worth by itself. A part that has
/// more to show than its text, as a place or a help, is marked with `#[diagnostic(transparent)]`.
#[macro_export]
macro_rules! sum_of_errors {
    (
        $(#[$about:meta])*
        pub enum $name:ident { $( $(#[$what:meta])* $variant:ident($part:ty), )+ }
    ) => {
        $(#[$about])*
        #[derive(Debug, thiserror::Error, miette::Diagnostic)]
        pub enum $name {
            $( $(#[$what])* #[error(transparent)] $variant(#[from] $part), )+
        }

        impl $crate::error::Exit for $name {
            fn exit_code(&self) -> $crate::error::ExitCode {
                match self {
                    $( Self::$variant(part) => $crate::error::Exit::exit_code(part), )+
                }
            }
        }
    };
}
