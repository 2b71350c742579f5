//! Who may ask: the session's own page, and nobody else's.
//!
//! A page of another origin can make a browser ask this server, and a name can be made to mean this machine. So the
//! host that is asked for must be an address or `localhost`, and an origin, where a browser states one, must be that host.

use axum::http::HeaderMap;
use axum::http::header::{HOST, ORIGIN};

/// Why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Foreign {
    #[error("the request does not say which host it is for")]
    NoHost,
    #[error("the request is for a host by name; ask by its address, or by `localhost`")]
    Name,
    #[error("the request comes from a page of another origin")]
    Origin,
}

/// Lets in what comes from this server's own page, or from a program. `scheme` is what the page is served by.
pub(super) fn admit(headers: &HeaderMap, scheme: &str) -> Result<(), Foreign> {
    let host = headers.get(HOST).and_then(|host| host.to_str().ok()).ok_or(Foreign::NoHost)?;
    if !is_address(host) {
        return Err(Foreign::Name);
    }
    match headers.get(ORIGIN) {
        None => Ok(()),
        Some(origin) => {
            match origin.to_str().ok().and_then(|origin| origin.strip_prefix(scheme)?.strip_prefix("://")) {
                Some(from) if from.eq_ignore_ascii_case(host) => Ok(()),
                _ => Err(Foreign::Origin),
            }
        }
    }
}

/// An address with a port or without, or `localhost`.
fn is_address(host: &str) -> bool {
    let bare = host
        .rsplit_once(':')
        .map_or(host, |(bare, port)| if port.bytes().all(|digit| digit.is_ascii_digit()) { bare } else { host });
    let bare = bare.strip_prefix('[').and_then(|inner| inner.strip_suffix(']')).unwrap_or(bare);
    bare.eq_ignore_ascii_case("localhost") || bare.parse::<std::net::IpAddr>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(host: Option<&str>, origin: Option<&str>) -> Result<(), Foreign> {
        let mut headers = HeaderMap::new();
        if let Some(host) = host {
            headers.insert(HOST, host.parse().expect("a header"));
        }
        if let Some(origin) = origin {
            headers.insert(ORIGIN, origin.parse().expect("a header"));
        }
        admit(&headers, "http")
    }

    #[test]
    fn the_own_page_and_programs_are_let_in() {
        for host in ["127.0.0.1:8080", "localhost:8080", "[::1]:8080", "localhost", "192.168.1.7:80"] {
            assert_eq!(asked(Some(host), None), Ok(()), "{host}");
            assert_eq!(asked(Some(host), Some(&format!("http://{host}"))), Ok(()), "{host}");
        }
    }

    #[test]
    fn other_origins_and_names_are_refused() {
        assert_eq!(asked(None, None), Err(Foreign::NoHost));
        assert_eq!(asked(Some("evil.example:8080"), None), Err(Foreign::Name));
        assert_eq!(asked(Some("127.0.0.1.evil.example"), None), Err(Foreign::Name));
        for origin in ["http://evil.example", "null", "https://127.0.0.1:8080", "http://127.0.0.1:8081", "file://"] {
            assert_eq!(asked(Some("127.0.0.1:8080"), Some(origin)), Err(Foreign::Origin), "{origin}");
        }
    }
}
