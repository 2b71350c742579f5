//! What a token lets its holder do.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use crate::signal::ClientName;
use crate::wire::message;

/// What somebody may do to a session; written `client:NAME`, `operator`, `trainer` or `viewer`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// Take part as this client.
    Client(ClientName),
    /// Ask how it is, and do whatever operators can.
    Operator,
    /// The same, and sit where trainers do.
    Trainer,
    /// Ask how it is.
    Viewer,
}

/// A text that is not a role.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("a role is `operator`, `trainer`, `viewer` or `client:NAME`, as in `client:plant`")]
pub struct BadRole;

impl Role {
    /// True if it lets somebody in who says `hello` as `role`. Which client somebody may be is seen when it joins.
    pub fn admits(&self, role: message::Role) -> bool {
        match role {
            message::Role::Client => matches!(self, Self::Client(_)),
            message::Role::Operator => matches!(self, Self::Operator | Self::Trainer | Self::Viewer),
        }
    }

    /// True if its holder may do what operators can.
    pub fn operates(&self) -> bool {
        matches!(self, Self::Operator | Self::Trainer)
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Client(name) => write!(f, "client:{name}"),
            Self::Operator => f.write_str("operator"),
            Self::Trainer => f.write_str("trainer"),
            Self::Viewer => f.write_str("viewer"),
        }
    }
}

impl FromStr for Role {
    type Err = BadRole;

    fn from_str(text: &str) -> Result<Self, BadRole> {
        match text {
            "operator" => Ok(Self::Operator),
            "trainer" => Ok(Self::Trainer),
            "viewer" => Ok(Self::Viewer),
            _ => {
                let name = text.strip_prefix("client:").ok_or(BadRole)?;
                ClientName::new(name).map(Self::Client).map_err(|_| BadRole)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roles_are_written_as_they_are_read() {
        for text in ["operator", "trainer", "viewer", "client:plant"] {
            assert_eq!(text.parse::<Role>().unwrap().to_string(), text);
        }
        for text in ["client", "client:", "client:a b", "Operator", ""] {
            assert_eq!(text.parse::<Role>(), Err(BadRole), "{text}");
        }
    }

    #[test]
    fn a_viewer_comes_as_an_operator_and_not_as_a_client() {
        let client = Role::Client(ClientName::new("plant").unwrap());
        assert!(Role::Viewer.admits(message::Role::Operator) && !Role::Viewer.admits(message::Role::Client));
        assert!(Role::Operator.admits(message::Role::Operator) && !Role::Operator.admits(message::Role::Client));
        assert!(client.admits(message::Role::Client) && !client.admits(message::Role::Operator));
    }
}
