//! Sessions of toy clients, through the public API.
