//! The syntax tree: what is written, with its place; no meanings.

mod chart;
mod configuration;
mod declaration;
mod expression;
pub mod instruction;
mod object;
mod statement;

pub use chart::{ActionQualifier, Association, Chart, ChartStep, Priority, Transition, TransitionCondition};
pub use configuration::{
    AccessDirection, AccessPath, Configuration, Connection, InstanceValue, ProgramDeclaration, Resource,
    TaskDeclaration,
};
pub use declaration::{
    Declaration, Dimension, Edge, ElementInit, EnumValue, Field, INITIAL_CALL, InitArguments, Initialiser,
    InitialiserKind, Pou, PouKind, Qualifier, ReferenceKind, Section, SectionKind, StructureInit, Subrange,
    TypeDeclaration, TypeSpec, TypeSpecKind, Variable,
};
pub use expression::{
    Argument, BinaryOp, CHAIN_HEIGHT, Call, Expr, ExprKind, Link, Literal, MAX_HEIGHT, TypedValue, UnaryOp,
};
pub use instruction::{Instruction, ListCall, When};
pub use object::{Member, MemberKind, Modifier, Namespace, NamespaceKind, Object};
pub use statement::{
    CaseBranch, CaseLabel, CaseStatement, ForStatement, IfBranch, IfStatement, RepeatStatement, Statement,
    StatementKind, TryStatement, UpdateOp, WhileStatement,
};

use crate::dialect::{Dialect, WordSize};
use crate::source::Span;

/// A name as written.
#[derive(Debug, Clone)]
pub struct Ident {
    /// Its text; names are compared without regard to case (2nd ed. 2.1.2).
    pub text: String,
    pub span: Span,
}

impl Ident {
    /// The form in which names are compared.
    pub fn key(&self) -> String {
        self.bare().to_ascii_uppercase()
    }

    /// True if this is the form of the name, which it need not make for that.
    pub fn has_key(&self, key: &str) -> bool {
        self.bare().eq_ignore_ascii_case(key)
    }

    fn bare(&self) -> &str {
        self.text.trim_start_matches('.').trim_matches('"')
    }

    /// True for `"name"` of SCL and `.name` of CODESYS, which is never a local one.
    pub fn is_global(&self) -> bool {
        self.text.starts_with(['"', '.'])
    }

    /// The key without the constants of a generic block: that of `List` for `List<8>`.
    pub fn template_key(&self) -> String {
        let key = self.key();
        key.split_once('<').map_or(key.as_str(), |(template, _)| template).to_owned()
    }
}

/// What a file declares, in its order.
#[derive(Debug, Clone, Default)]
pub struct CompilationUnit {
    /// The dialect it is written in.
    pub dialect: Dialect,
    /// Bits of the registers of the target that runs it.
    pub word_size: WordSize,
    pub declarations: Vec<Declaration>,
    /// Where generic blocks are named with their constants.
    pub templates: Vec<TemplateUse>,
}

/// `List<8>`: a block that is made of a generic one (CODESYS, TwinCAT). The whole of it stands as one name in the tree.
#[derive(Debug, Clone)]
pub struct TemplateUse {
    /// The name of the generic block.
    pub template: Ident,
    pub arguments: Vec<Expr>,
    /// Where all of it stands.
    pub span: Span,
}
