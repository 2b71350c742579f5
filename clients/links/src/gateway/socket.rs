//! The TCP connection that several links begin with.

use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

/// How long a connection may take to come about, and a request to be answered, if the scenario does not say.
pub(super) const REQUEST_TIMEOUT: Duration = Duration::from_secs(3);

/// The host and the port of `address`, `usual` where it has none.
///
/// # Errors
/// What stands behind the colon is not a port.
pub(super) fn host_and_port(address: &str, usual: u16) -> Result<(&str, u16), String> {
    match address.rsplit_once(':') {
        Some((host, port)) => Ok((host, port.parse().map_err(|_| format!("`{port}` is not a port"))?)),
        None => Ok((address, usual)),
    }
}

/// A connection to the first of the addresses that answers, for one request at a time.
///
/// # Errors
/// Why the last of them does not, for people.
pub(super) fn connect(addresses: impl ToSocketAddrs, timeout: Duration) -> Result<TcpStream, String> {
    let mut reason = "no such host".to_owned();
    for address in addresses.to_socket_addrs().map_err(|error| error.to_string())? {
        match TcpStream::connect_timeout(&address, timeout) {
            Ok(stream) => {
                return prepare(&stream, timeout).map(|()| stream).map_err(|error| error.to_string());
            }
            Err(error) => reason = error.to_string(),
        }
    }
    Err(reason)
}

/// For one request at a time: none waits for more to come, and none for longer than `timeout` to be taken.
///
/// # Errors
/// The connection is gone.
pub(super) fn prepare(stream: &TcpStream, timeout: Duration) -> std::io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(timeout))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_may_have_a_port() {
        assert_eq!(host_and_port("plc", 102), Ok(("plc", 102)));
        assert_eq!(host_and_port("192.168.0.1:1102", 102), Ok(("192.168.0.1", 1102)));
        assert_eq!(host_and_port("plc:x", 102), Err("`x` is not a port".to_owned()));
    }
}
