//! Who comes in, where a token is asked for, and what they may do.
//!
//! A program shows its token with every request (`Authorization: Bearer`). A person types it once: the browser is given a
//! cookie that is good until the session ends, which no script can read and which no other page can send.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use axum::http::HeaderMap;
use axum::http::header::{AUTHORIZATION, COOKIE};
use onescan_server::access::{BadToken, Holder, Register, Role, Token, TokenHash, TokenRefusal};
use thiserror::Error;

use crate::access::tokens::today;

/// Browsers that are known at a time; who came first has to log in again.
const KNOWN_MAX: usize = 1_024;
/// Browsers that one token lets in at a time, of which the same holds: nobody's logins push others out.
const KNOWN_OF_TOKEN_MAX: usize = 32;

/// What somebody may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    Looks,
    /// Operate, from the seats of operators.
    Operates,
    /// Operate from all seats.
    Trains,
}

/// Why somebody is not let in.
#[derive(Debug, Error)]
pub(super) enum AuthError {
    #[error("{0}")]
    Token(#[from] TokenRefusal),
    #[error("token `{0}` is for a client of a session: the page is for operators, trainers and viewers")]
    Client(String),
    #[error("token `{0}` is not a trainer's, and this is the trainer's page")]
    NotTrainers(String),
    #[error(transparent)]
    NoRandomness(#[from] BadToken),
}

/// The door of a page.
#[derive(Debug)]
pub(super) enum Entry {
    Open,
    /// Whoever shows a token.
    Tokens {
        register: Register,
        known: Mutex<VecDeque<Known>>,
        cookie: String,
        is_tls: bool,
        /// Whether trainers alone are let in.
        is_trainers: bool,
    },
}

/// A browser that has logged in.
#[derive(Debug)]
pub(super) struct Known {
    cookie: TokenHash,
    rank: Rank,
    /// The name of the token that it has shown.
    token: String,
}

impl Entry {
    /// The door of a page at `port`: cookies do not distinguish ports, so their names do.
    pub(super) fn new(register: Option<Register>, port: u16, is_tls: bool) -> Self {
        match register {
            None => Self::Open,
            Some(register) => {
                let cookie = format!("onescan_{port}");
                Self::Tokens { register, known: Mutex::default(), cookie, is_tls, is_trainers: false }
            }
        }
    }

    /// The same for trainers alone: others would see what the trainee may not.
    pub(super) fn for_trainers(mut self) -> Self {
        if let Self::Tokens { is_trainers, .. } = &mut self {
            *is_trainers = true;
        }
        self
    }

    /// What whoever asks with these headers may do.
    pub(super) fn admit(&self, headers: &HeaderMap) -> Result<Rank, AuthError> {
        let Self::Tokens { register, known, cookie, is_trainers, .. } = self else { return Ok(Rank::Trains) };
        let bearer = headers.get(AUTHORIZATION).and_then(|value| value.to_str().ok()?.strip_prefix("Bearer "));
        if let Some(token) = bearer {
            return rank(register.holder(Some(token), today())?, *is_trainers);
        }
        let shown = headers.get_all(COOKIE).iter().filter_map(|value| value.to_str().ok());
        let mut pairs = shown.flat_map(|all| all.split(';')).filter_map(|pair| pair.trim().split_once('='));
        let Some((_, secret)) = pairs.find(|(name, _)| name == cookie) else {
            return Err(TokenRefusal::Missing.into());
        };
        let hash = TokenHash::of(secret);
        let known = known.lock().unwrap_or_else(PoisonError::into_inner);
        // all are compared, in constant time each
        let found = known
            .iter()
            .fold(None, |found, kept| if bool::from(kept.cookie.matches(&hash)) { Some(kept.rank) } else { found });
        found.ok_or_else(|| TokenRefusal::Missing.into())
    }

    /// Takes a token that somebody has typed; gives the cookie for the browser.
    pub(super) fn log_in(&self, token: &str) -> Result<String, AuthError> {
        let Self::Tokens { register, known, cookie, is_tls, is_trainers } = self else { return Ok(String::new()) };
        let holder = register.holder(Some(token.trim()), today())?;
        let token = holder.name.clone();
        let rank = rank(holder, *is_trainers)?;
        let secret = Token::generate()?;
        let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
        if known.iter().filter(|each| each.token == token).count() >= KNOWN_OF_TOKEN_MAX {
            let first = known.iter().position(|each| each.token == token);
            first.and_then(|first| known.remove(first));
        } else if known.len() >= KNOWN_MAX {
            known.pop_front();
        }
        known.push_back(Known { cookie: secret.hash(), rank, token });
        let secure = if *is_tls { "; Secure" } else { "" };
        Ok(format!("{cookie}={}; HttpOnly; SameSite=Strict; Path=/{secure}", secret.reveal()))
    }
}

fn rank(holder: Holder, is_trainers: bool) -> Result<Rank, AuthError> {
    match holder.role {
        Role::Viewer | Role::Operator if is_trainers => Err(AuthError::NotTrainers(holder.name)),
        Role::Viewer => Ok(Rank::Looks),
        Role::Operator => Ok(Rank::Operates),
        Role::Trainer => Ok(Rank::Trains),
        Role::Client(_) => Err(AuthError::Client(holder.name)),
    }
}

/// The form in which a token is typed, with what was wrong with the last one.
pub(super) fn form(wrong: Option<&str>) -> String {
    let escaped = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let wrong = wrong.map(|text| format!("<p role=\"alert\">{}</p>", escaped(text))).unwrap_or_default();
    format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width\"><meta name=\"color-scheme\" content=\"light dark\"><title>onescan</title><style>body \
         {{ font: 16px/1.5 system-ui, sans-serif; max-width: 34em; margin: 15vh auto; padding: 0 1em }} input {{ width: 100%; \
         font: inherit; margin: .5em 0 }}</style></head><body><h1>onescan</h1><p>This session asks for a token, as <code>onescan \
         token new</code> prints it.</p>{wrong}<form method=\"post\" action=\"/api/login\"><label>Token <input type=\"password\" \
         name=\"token\" autocomplete=\"off\" autofocus required></label><button>Come in</button></form></body></html>\n"
    )
}

/// The token in a form that was sent. Tokens have no letter that forms write otherwise.
pub(super) fn typed(body: &[u8]) -> Option<&str> {
    std::str::from_utf8(body).ok()?.split('&').find_map(|pair| pair.strip_prefix("token="))
}

#[cfg(test)]
mod tests {
    use onescan_server::access::Pass;

    use super::*;

    fn door(tokens: &[(&str, &str)]) -> (Entry, Vec<Token>) {
        let mut register = Register::default();
        let mut made = Vec::new();
        for (name, role) in tokens {
            let token = Token::generate().unwrap();
            let pass =
                Pass { name: (*name).to_owned(), role: role.parse().unwrap(), expires: None, hash: token.hash() };
            register.add(pass).unwrap();
            made.push(token);
        }
        (Entry::new(Some(register), 8080, true), made)
    }

    fn showing(name: &str, value: &str) -> HeaderMap {
        let mut headers = HeaderMap::new();
        headers.insert(axum::http::HeaderName::from_bytes(name.as_bytes()).unwrap(), value.parse().unwrap());
        headers
    }

    #[test]
    fn a_role_is_what_somebody_may_do() {
        let (door, tokens) =
            door(&[("wall", "viewer"), ("anna", "operator"), ("tom", "trainer"), ("cell", "client:plc")]);
        let admit = |token: &Token| door.admit(&showing("authorization", &format!("Bearer {}", token.reveal())));
        assert_eq!(admit(&tokens[0]).unwrap(), Rank::Looks);
        assert_eq!(admit(&tokens[1]).unwrap(), Rank::Operates);
        assert_eq!(admit(&tokens[2]).unwrap(), Rank::Trains);
        assert!(matches!(admit(&tokens[3]), Err(AuthError::Client(name)) if name == "cell"));
        assert!(matches!(admit(&Token::generate().unwrap()), Err(AuthError::Token(TokenRefusal::Unknown))));
        assert!(matches!(door.admit(&HeaderMap::new()), Err(AuthError::Token(TokenRefusal::Missing))));
        assert_eq!(Entry::new(None, 1, false).admit(&HeaderMap::new()).unwrap(), Rank::Trains);
    }

    #[test]
    fn the_trainers_page_is_for_trainers() {
        let (door, tokens) = door(&[("wall", "viewer"), ("anna", "operator"), ("tom", "trainer")]);
        let door = door.for_trainers();
        let admit = |token: &Token| door.admit(&showing("authorization", &format!("Bearer {}", token.reveal())));
        assert!(matches!(admit(&tokens[0]), Err(AuthError::NotTrainers(name)) if name == "wall"));
        assert!(matches!(admit(&tokens[1]), Err(AuthError::NotTrainers(name)) if name == "anna"));
        assert_eq!(admit(&tokens[2]).unwrap(), Rank::Trains);
        assert!(door.log_in(tokens[1].reveal()).is_err() && door.log_in(tokens[2].reveal()).is_ok());
    }

    #[test]
    fn a_cookie_is_good_for_its_port_and_no_script_sees_it() {
        let (door, tokens) = door(&[("anna", "operator")]);
        let cookie = door.log_in(&format!(" {}\n", tokens[0].reveal())).unwrap();
        assert!(cookie.starts_with("onescan_8080=") && cookie.ends_with("; HttpOnly; SameSite=Strict; Path=/; Secure"));
        assert!(!cookie.contains(tokens[0].reveal()), "the token itself is not kept by the browser");
        let pair = cookie.split(';').next().unwrap();
        assert_eq!(door.admit(&showing("cookie", &format!("a=b; {pair}"))).unwrap(), Rank::Operates);
        for wrong in [pair.replace("8080", "8081"), format!("{pair}0"), "onescan_8080=".to_owned()] {
            assert!(door.admit(&showing("cookie", &wrong)).is_err(), "{wrong}");
        }
        assert!(door.log_in("x").is_err());
    }

    #[test]
    fn logins_with_one_token_push_nobody_else_out() {
        let (door, tokens) = door(&[("anna", "operator"), ("wall", "viewer")]);
        let log_in = |token: &Token| door.log_in(token.reveal()).unwrap().split(';').next().unwrap().to_owned();
        let rank = |cookie: &str| door.admit(&showing("cookie", cookie)).ok();
        let operator = log_in(&tokens[0]);
        let viewers: Vec<String> = (0..1_100).map(|_| log_in(&tokens[1])).collect();
        assert_eq!(rank(&operator), Some(Rank::Operates));
        assert_eq!((rank(&viewers[0]), rank(&viewers[1_099])), (None, Some(Rank::Looks)));
    }

    #[test]
    fn what_was_wrong_is_shown_as_text() {
        assert!(form(Some("<script>")).contains("&lt;script&gt;"));
        assert_eq!(typed(b"a=b&token=onescan_12"), Some("onescan_12"));
        assert_eq!((typed(b"tok=1"), typed(&[0xff])), (None, None));
    }
}
