//! Who comes in with which user, and who was sent away and why.

use std::collections::BTreeMap;

use async_trait::async_trait;
use opcua::crypto::Thumbprint;
use opcua::server::authenticator::{AuthManager, DefaultAuthenticator, Password, UserToken};
use opcua::server::{ServerEndpoint, ServerUserToken};
use opcua::types::{ByteString, Error, UserTokenPolicy};

use super::Refusals;

/// The users of a server.
pub(super) struct Doorkeeper {
    users: DefaultAuthenticator,
    refusals: Refusals,
}

impl Doorkeeper {
    pub(super) fn new(users: BTreeMap<String, ServerUserToken>, refusals: Refusals) -> Self {
        Self { users: DefaultAuthenticator::new(users), refusals }
    }

    fn noted<T>(&self, who: &str, done: Result<T, Error>) -> Result<T, Error> {
        done.inspect_err(|error| self.refusals.note(format!("{who}: {}", error.status())))
    }
}

#[async_trait]
impl AuthManager for Doorkeeper {
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
        let done = self.users.authenticate_username_identity_token(endpoint, username, password).await;
        self.noted(&format!("user `{username}` over OPC UA"), done)
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
