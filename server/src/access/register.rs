//! All tokens that are good for a session, and the question whether one lets somebody in.

use std::fmt;

use onescan_base::foreign::one_line;
use subtle::{Choice, ConditionallySelectable};
use thiserror::Error;

use super::day::Day;
use super::role::Role;
use super::token::TokenHash;
use crate::signal::ClientName;
use crate::wire::message;

/// Most tokens of one register: each is looked at whenever one is shown.
pub const PASSES_MAX: usize = 4_096;

/// A token as it is kept.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Pass {
    /// What people call it.
    pub name: String,
    /// What it is good for.
    pub role: Role,
    /// The last day on which it is good.
    pub expires: Option<Day>,
    pub hash: TokenHash,
}

/// With what somebody has shown who he is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Proof {
    Token,
    /// A certificate that an authority of the session has signed.
    Certificate,
}

impl fmt::Display for Proof {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Token => "token",
            Self::Certificate => "certificate",
        })
    }
}

/// Somebody whose token or certificate was good.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Holder {
    /// The name of the token, or that in the certificate.
    pub name: String,
    /// What it is good for.
    pub role: Role,
    pub proof: Proof,
}

impl Holder {
    /// The same, if it is good for somebody who says `hello` as `role`.
    ///
    /// # Errors
    /// It is good for something else.
    pub fn admitted(self, role: message::Role) -> Result<Self, TokenRefusal> {
        if self.role.admits(role) {
            return Ok(self);
        }
        let wanted = match role {
            message::Role::Client => "a client",
            message::Role::Operator => "an operator",
        };
        Err(TokenRefusal::OtherRole { proof: self.proof, name: self.name, role: self.role, wanted })
    }
}

/// All tokens that are good for a session.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Register {
    passes: Vec<Pass>,
}

/// Why tokens cannot be put together.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RegisterError {
    /// Two of one name.
    #[error("there is a token `{}` already: revoke it, or choose another name", one_line(.0))]
    Doubled(String),
    /// A name that cannot be distinguished from others.
    #[error("`{}` cannot be the name of a token: use letters, digits, `_`, `.`, `-` and `@`, 64 at most", one_line(.0))]
    BadName(String),
    #[error("there are {PASSES_MAX} tokens, and there may not be more: revoke some")]
    TooMany,
}

/// Why somebody is not let in.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TokenRefusal {
    #[error(
        "this session lets nobody in without a token: give one in `token` of `hello` (`--token-file`, ONESCAN_TOKEN)"
    )]
    Missing,
    /// Not one of this session's.
    #[error("the token is not one of this session's: it may have been revoked, or be another session's")]
    Unknown,
    #[error("token `{name}` expired: its last day was {last}")]
    Expired { name: String, last: Day },
    #[error("{proof} `{name}` is good for `{role}`, not to be {wanted}")]
    OtherRole {
        proof: Proof,
        name: String,
        /// What it is good for.
        role: Role,
        /// What its holder wants to be.
        wanted: &'static str,
    },
    #[error("{proof} `{name}` is good for `{role}`, not for client `{wanted}`")]
    OtherClient {
        proof: Proof,
        name: String,
        /// What it is good for.
        role: Role,
        /// Who its holder wants to be.
        wanted: ClientName,
    },
    #[error("{proof} `{name}` lets its holder look, and change nothing")]
    LooksOnly { proof: Proof, name: String },
}

impl Register {
    /// The tokens.
    pub fn passes(&self) -> &[Pass] {
        &self.passes
    }

    /// Adds one.
    ///
    /// # Errors
    /// See [`RegisterError`].
    pub fn add(&mut self, pass: Pass) -> Result<(), RegisterError> {
        let inside = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '-' | '@');
        if pass.name.is_empty() || pass.name.len() > 64 || !pass.name.chars().all(inside) {
            return Err(RegisterError::BadName(pass.name));
        }
        if self.passes.iter().any(|known| known.name == pass.name) {
            return Err(RegisterError::Doubled(pass.name));
        }
        if self.passes.len() >= PASSES_MAX {
            return Err(RegisterError::TooMany);
        }
        self.passes.push(pass);
        Ok(())
    }

    /// Adds the token of a program that the session itself has started, to take part as `client`.
    pub fn issue(&mut self, client: &ClientName, hash: TokenHash) {
        let name = format!("(this session's, for {client})");
        self.passes.push(Pass { name, role: Role::Client(client.clone()), expires: None, hash });
    }

    /// Takes the token `name` out; false if there is none.
    pub fn revoke(&mut self, name: &str) -> bool {
        let before = self.passes.len();
        self.passes.retain(|pass| pass.name != name);
        self.passes.len() < before
    }

    /// Whose token was shown, if it is good today for somebody who says `hello` as `role`.
    ///
    /// # Errors
    /// See [`TokenRefusal`].
    pub fn admit(&self, shown: Option<&str>, role: message::Role, today: Day) -> Result<Holder, TokenRefusal> {
        self.holder(shown, today)?.admitted(role)
    }

    /// Whose token was shown, if it is good today. All are compared, in constant time, whichever it is.
    ///
    /// # Errors
    /// None was shown, it is not one of these, or it is too old.
    pub fn holder(&self, shown: Option<&str>, today: Day) -> Result<Holder, TokenRefusal> {
        let hash = TokenHash::of(shown.ok_or(TokenRefusal::Missing)?);
        let (mut found, mut index) = (Choice::from(0), 0);
        for (at, pass) in (0_u32..).zip(&self.passes) {
            let is_it = pass.hash.matches(&hash);
            index = u32::conditional_select(&index, &at, is_it);
            found |= is_it;
        }
        let pass = if bool::from(found) { self.passes.get(index as usize) } else { None };
        let Pass { name, role, expires, .. } = pass.ok_or(TokenRefusal::Unknown)?.clone();
        match expires {
            Some(last) if today > last => Err(TokenRefusal::Expired { name, last }),
            _ => Ok(Holder { name, role, proof: Proof::Token }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::Token;

    fn register() -> (Register, Vec<Token>) {
        let mut register = Register::default();
        let mut tokens = Vec::new();
        for (name, role, expires) in
            [("anna", "operator", None), ("wall", "viewer", Some("2026-12-31")), ("cell", "client:plant", None)]
        {
            let token = Token::generate().unwrap();
            let (role, expires) = (role.parse().unwrap(), expires.map(|day| day.parse().unwrap()));
            register.add(Pass { name: name.to_owned(), role, expires, hash: token.hash() }).unwrap();
            tokens.push(token);
        }
        (register, tokens)
    }

    fn day(text: &str) -> Day {
        text.parse().unwrap()
    }

    #[test]
    fn each_reason_has_its_name() {
        use message::Role::{Client, Operator};
        let (mut register, tokens) = register();
        let today = day("2026-12-31");
        let said = |register: &Register, token: Option<&str>, role, today| match register.admit(token, role, today) {
            Ok(holder) => format!("{} as {}", holder.name, holder.role),
            Err(refusal) => refusal.to_string(),
        };
        let shown: Vec<_> = tokens.iter().map(|token| Some(token.reveal())).collect();
        assert_eq!(said(&register, shown[0], Operator, today), "anna as operator");
        assert_eq!(said(&register, shown[1], Operator, today), "wall as viewer");
        assert_eq!(said(&register, shown[2], Client, today), "cell as client:plant");
        assert!(said(&register, None, Client, today).starts_with("this session lets nobody in without a token"));
        assert!(said(&register, Some("x"), Client, today).starts_with("the token is not one of this session's"));
        assert_eq!(
            said(&register, shown[1], Operator, day("2027-01-01")),
            "token `wall` expired: its last day was 2026-12-31"
        );
        assert_eq!(said(&register, shown[0], Client, today), "token `anna` is good for `operator`, not to be a client");
        assert_eq!(
            said(&register, shown[2], Operator, today),
            "token `cell` is good for `client:plant`, not to be an operator"
        );
        assert!(register.revoke("anna") && !register.revoke("anna"));
        assert!(said(&register, shown[0], Operator, today).starts_with("the token is not one"));
    }

    #[test]
    fn names_are_distinguished() {
        let (mut register, _) = register();
        let pass = Pass { name: "anna".into(), role: Role::Viewer, expires: None, hash: TokenHash::of("x") };
        assert_eq!(register.add(pass.clone()), Err(RegisterError::Doubled("anna".into())));
        for name in ["", "a b", "a\u{1b}", &"x".repeat(65)] {
            let pass = Pass { name: name.to_owned(), ..pass.clone() };
            assert!(matches!(register.add(pass), Err(RegisterError::BadName(_))), "{name}");
        }
    }
}
