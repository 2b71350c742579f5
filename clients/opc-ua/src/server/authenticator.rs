//! Who comes in with which user, and who was sent away and why.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use async_trait::async_trait;
use onescan_base::foreign::one_line;
use onescan_server::access::{Day, Register};
use onescan_server::wire::message;
use opcua::crypto::Thumbprint;
use opcua::server::authenticator::{AuthManager, DefaultAuthenticator, Password, UserToken};
use opcua::server::{ServerEndpoint, ServerUserToken};
use opcua::types::{ByteString, Error, StatusCode, UserTokenPolicy};

use onescan_links::opcua::Refusals;

/// The users of a server.
pub(super) struct Authenticator {
    users: DefaultAuthenticator,
    /// Tokens that are good, in place of the users.
    register: Option<Arc<Register>>,
    refusals: Refusals,
}

impl Authenticator {
    pub(super) fn new(
        users: BTreeMap<String, ServerUserToken>,
        register: Option<Arc<Register>>,
        refusals: Refusals,
    ) -> Self {
        Self { users: DefaultAuthenticator::new(users), register, refusals }
    }

    fn noted<T>(&self, who: &str, done: Result<T, Error>) -> Result<T, Error> {
        done.inspect_err(|error| self.refusals.note(format!("{who}: {}", error.status())))
    }
}

/// The user whose token is the password: an operator's, or a viewer's, who reads and changes nothing.
fn holder_of(register: &Register, username: &str, token: &str) -> Result<UserToken, Error> {
    let today = Day::of(SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default());
    let refused = |why: String| Error::new(StatusCode::BadIdentityTokenRejected, why);
    let holder = register.holder(Some(token), today).map_err(|refusal| refused(refusal.to_string()))?;
    if holder.name != username {
        return Err(refused(format!("the token is good for another user than `{}`", one_line(username))));
    }
    if !holder.role.admits(message::Role::Operator) {
        return Err(refused(format!(
            "token `{}` is good for `{}`: over OPC UA it must be an operator's or a viewer's",
            holder.name, holder.role
        )));
    }
    Ok(UserToken(holder.name))
}

#[async_trait]
impl AuthManager for Authenticator {
    async fn authenticate_anonymous_token(&self, endpoint: &ServerEndpoint) -> Result<(), Error> {
        let done = self.users.authenticate_anonymous_token(endpoint).await;
        self.noted("an OPC UA client without a user", done)
    }

    async fn authenticate_username_identity_token(
        &self,
        endpoint: &ServerEndpoint,
        username: &str,
        password: &Password,
    ) -> Result<UserToken, Error> {
        let done = match &self.register {
            Some(register) => holder_of(register, username, password.get()),
            None => self.users.authenticate_username_identity_token(endpoint, username, password).await,
        };
        self.noted(&format!("user `{}` over OPC UA", one_line(username)), done)
    }

    async fn authenticate_x509_identity_token(
        &self,
        endpoint: &ServerEndpoint,
        signing_thumbprint: &Thumbprint,
    ) -> Result<UserToken, Error> {
        let done = self.users.authenticate_x509_identity_token(endpoint, signing_thumbprint).await;
        self.noted("a user with a certificate over OPC UA", done)
    }

    async fn authenticate_issued_identity_token(
        &self,
        endpoint: &ServerEndpoint,
        token: &ByteString,
    ) -> Result<UserToken, Error> {
        let done = self.users.authenticate_issued_identity_token(endpoint, token).await;
        self.noted("a user with an issued token over OPC UA", done)
    }

    /// A client that comes without a user is asked in, so that it is sent away by name.
    fn supports_anonymous(&self, _endpoint: &ServerEndpoint) -> bool {
        true
    }

    fn user_token_policies(&self, endpoint: &ServerEndpoint) -> Vec<UserTokenPolicy> {
        self.users.user_token_policies(endpoint)
    }
}
