//! What is asked for in a message of an S7, and what is answered: agreeing on a length, reading and writing bytes of
//! data blocks.
//!
//! | head | |
//! |---|---|
//! | 0x32, kind, 2 bytes of room, number of the request | the answer has the request's number |
//! | length of the parameters, length of the data | 2 bytes each |
//! | error | 2 bytes, in an answer only |
//!
//! Numbers have their high byte first.

/// The first byte of every message.
const PROTOCOL: u8 = 0x32;
const REQUEST: u8 = 1;
/// An answer without data.
const ACKNOWLEDGEMENT: u8 = 2;
const ANSWER: u8 = 3;

const SETUP: u8 = 0xF0;
const READ: u8 = 4;
const WRITE: u8 = 5;

/// Bytes of a request's head.
const REQUEST_HEAD: usize = 10;
/// Bytes of an answer's head.
const ANSWER_HEAD: usize = 12;
/// Bytes of an address in a request.
const ITEM: usize = 12;
/// Bytes in front of a value.
const VALUE_HEAD: usize = 4;
/// Function and count, in front of addresses or values.
const COUNTED: usize = 2;
/// The most addresses in one request.
pub const ITEMS_MAX: usize = 20;
/// The longest message that anybody agrees on.
pub const PDU_MAX: u16 = 960;
/// The shortest one that an S7 has.
pub const PDU_MIN: u16 = 240;

/// Data blocks, among the areas of memory.
const AREA_DB: u8 = 0x84;
/// A value of bytes, in a request for it.
const BYTES: u8 = 2;
/// A value whose length is counted in bits.
const COUNTED_IN_BITS: u8 = 4;
/// A value whose length is counted in bytes.
const COUNTED_IN_BYTES: u8 = 9;

/// What was asked for has been done.
pub const DONE: u8 = 0xFF;
/// It may not be read or written.
pub const NO_ACCESS: u8 = 0x03;
/// The block is shorter.
pub const OUT_OF_RANGE: u8 = 0x05;
/// It is not asked for as bytes.
pub const NO_TYPE: u8 = 0x06;
/// There is no such block.
pub const NO_OBJECT: u8 = 0x0A;
/// The error of a whole request: the PLC does not do this.
pub const NOT_AVAILABLE: u16 = 0x8104;

/// Bytes of a data block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// Number of the block.
    pub db: u16,
    pub at: u32,
    pub len: u16,
}

/// Bytes that one message of `pdu` bytes reads at most.
pub fn read_max(pdu: u16) -> usize {
    usize::from(pdu).saturating_sub(ANSWER_HEAD + COUNTED + VALUE_HEAD)
}

/// Bytes that one message of `pdu` bytes writes at most.
pub fn write_max(pdu: u16) -> usize {
    usize::from(pdu).saturating_sub(REQUEST_HEAD + COUNTED + ITEM + VALUE_HEAD)
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request {
    /// Messages may have so many bytes.
    Setup(u16),
    /// Bytes to be read; nothing for what is not asked for as bytes of a data block.
    Read(Vec<Option<Item>>),
    /// Bytes to be written.
    Write(Vec<(Option<Item>, Vec<u8>)>),
    /// Something that only larger servers do.
    Other,
}

/// A message that agrees on its longest.
pub fn setup(number: u16, pdu: u16) -> Vec<u8> {
    request(number, &setup_parameters(pdu), &[])
}

fn setup_parameters(pdu: u16) -> Vec<u8> {
    // One request at a time, either way.
    let [high, low] = pdu.to_be_bytes();
    vec![SETUP, 0, 0, 1, 0, 1, high, low]
}

/// A message that reads these bytes.
pub fn read(number: u16, item: Item) -> Vec<u8> {
    request(number, &address(READ, item), &[])
}

/// A message that writes these bytes. It could write more, in other places; not every server knows that.
pub fn write(number: u16, item: Item, bytes: &[u8]) -> Vec<u8> {
    let mut data = Vec::new();
    put_value(&mut data, 0, bytes);
    request(number, &address(WRITE, item), &data)
}

/// A function, and one address.
fn address(function: u8, Item { db, at, len }: Item) -> Vec<u8> {
    // The kind of an address with 10 bytes behind these two: any bytes.
    let mut parameters = vec![function, 1, 0x12, 10, 0x10, BYTES];
    parameters.extend([len.to_be_bytes(), db.to_be_bytes()].concat());
    // Counted in bits.
    let bits = (at << 3).to_be_bytes();
    parameters.extend([AREA_DB, bits[1], bits[2], bits[3]]);
    parameters
}

/// A value behind what is said of it, at an even place.
fn put_value(data: &mut Vec<u8>, code: u8, bytes: &[u8]) {
    if data.len() % 2 == 1 {
        data.push(0);
    }
    data.extend([code, COUNTED_IN_BITS]);
    data.extend(((bytes.len() * 8) as u16).to_be_bytes());
    data.extend(bytes);
}

fn request(number: u16, parameters: &[u8], data: &[u8]) -> Vec<u8> {
    message(REQUEST, number, None, parameters, data)
}

fn message(kind: u8, number: u16, error: Option<u16>, parameters: &[u8], data: &[u8]) -> Vec<u8> {
    let mut message = vec![PROTOCOL, kind, 0, 0];
    message.extend(number.to_be_bytes());
    message.extend((parameters.len() as u16).to_be_bytes());
    message.extend((data.len() as u16).to_be_bytes());
    message.extend(error.into_iter().flat_map(u16::to_be_bytes));
    message.extend(parameters);
    message.extend(data);
    message
}

/// The head of a message and its two parts.
struct Parts<'m> {
    kind: u8,
    number: u16,
    error: u16,
    parameters: &'m [u8],
    data: &'m [u8],
}

fn parts(message: &[u8]) -> Option<Parts<'_>> {
    let (head, rest) = message.split_first_chunk::<REQUEST_HEAD>()?;
    let [PROTOCOL, kind, _, _, n1, n0, p1, p0, d1, d0] = *head else { return None };
    let (error, rest) = if matches!(kind, ACKNOWLEDGEMENT | ANSWER) {
        let (error, rest) = rest.split_first_chunk::<2>()?;
        (u16::from_be_bytes(*error), rest)
    } else {
        (0, rest)
    };
    let (parameters, rest) = rest.split_at_checked(usize::from(u16::from_be_bytes([p1, p0])))?;
    let data = rest.get(..usize::from(u16::from_be_bytes([d1, d0])))?;
    Some(Parts { kind, number: u16::from_be_bytes([n1, n0]), error, parameters, data })
}

/// The values in `data`, each behind what is said of it.
struct Values<'d>(&'d [u8]);

impl<'d> Values<'d> {
    /// The next value, and its code.
    fn next(&mut self) -> Option<(u8, &'d [u8])> {
        let ([code, form, high, low], rest) = self.0.split_first_chunk::<VALUE_HEAD>()?;
        let count = usize::from(u16::from_be_bytes([*high, *low]));
        let len = match *form {
            // Nothing comes with an error.
            0 => 0,
            COUNTED_IN_BITS | 5 => count.div_ceil(8),
            3 | 6 | 7 | COUNTED_IN_BYTES => count,
            _ => return None,
        };
        let (value, rest) = rest.split_at_checked(len)?;
        self.0 = if len % 2 == 1 { rest.get(1..).unwrap_or_default() } else { rest };
        Some((*code, value))
    }
}

/// What came back for a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Messages may have so many bytes.
    Setup(u16),
    /// The bytes that were read.
    Bytes(Vec<u8>),
    /// What became of each value that was written.
    Written(Vec<u8>),
    /// The whole request was refused.
    Refused(u16),
    /// One value was refused.
    NotRead(u8),
}

/// The number of the request that a message answers, and what it says; nothing if it is not an answer.
pub fn answer(message: &[u8]) -> Option<(u16, Option<Answer>)> {
    let Parts { kind, number, error, parameters, data } = parts(message)?;
    if !matches!(kind, ACKNOWLEDGEMENT | ANSWER) {
        return None;
    }
    if error != 0 {
        return Some((number, Some(Answer::Refused(error))));
    }
    let answer = match parameters {
        [SETUP, _, _, _, _, _, high, low] => Some(Answer::Setup(u16::from_be_bytes([*high, *low]))),
        [READ, 1] => Values(data).next().map(|(code, value)| match code {
            DONE => Answer::Bytes(value.to_vec()),
            code => Answer::NotRead(code),
        }),
        [WRITE, count] if data.len() == usize::from(*count) => Some(Answer::Written(data.to_vec())),
        _ => None,
    };
    Some((number, answer))
}

/// The number of a request, and what it asks for; nothing if the message is not a request.
pub fn asked(message: &[u8]) -> Option<(u16, Request)> {
    let Parts { kind, number, parameters, data, .. } = parts(message)?;
    if kind != REQUEST {
        return Some((number, Request::Other));
    }
    let request = match parameters {
        [SETUP, _, _, _, _, _, high, low] => Request::Setup(u16::from_be_bytes([*high, *low])),
        [READ, _, items @ ..] => Request::Read(items_of(items)?),
        [WRITE, _, items @ ..] => {
            let mut values = Values(data);
            let with_value = |item| Some((item, values.next()?.1.to_vec()));
            Request::Write(items_of(items)?.into_iter().map(with_value).collect::<Option<_>>()?)
        }
        _ => Request::Other,
    };
    Some((number, request))
}

/// The addresses of a request; nothing in the place of one that is not bytes of a data block.
fn items_of(parameters: &[u8]) -> Option<Vec<Option<Item>>> {
    let (items, rest) = parameters.as_chunks::<ITEM>();
    rest.is_empty().then(|| items.iter().map(item_of).collect())
}

fn item_of(item: &[u8; ITEM]) -> Option<Item> {
    let [0x12, 10, 0x10, form, c1, c0, d1, d0, AREA_DB, a2, a1, a0] = *item else { return None };
    let width = match form {
        BYTES | 3 => 1,
        4 | 5 => 2,
        6..=8 => 4,
        _ => return None,
    };
    let bits = u32::from_be_bytes([0, a2, a1, a0]);
    let len = u16::from_be_bytes([c1, c0]).checked_mul(width)?;
    bits.is_multiple_of(8).then_some(Item { db: u16::from_be_bytes([d1, d0]), at: bits / 8, len })
}

/// The answer to [`Request::Setup`].
pub fn set_up(number: u16, pdu: u16) -> Vec<u8> {
    message(ANSWER, number, Some(0), &setup_parameters(pdu), &[])
}

/// The answer to [`Request::Read`]: the bytes, or why there are none.
pub fn values(number: u16, values: &[Result<Vec<u8>, u8>]) -> Vec<u8> {
    let mut data = Vec::new();
    for value in values {
        match value {
            Ok(bytes) => put_value(&mut data, DONE, bytes),
            Err(code) => {
                // A value begins at an even place: the byte that fills up is left out where it does already.
                let room = data.len() % 2;
                data.extend(&[0, *code, 0, 0, 0][1 - room..]);
            }
        }
    }
    message(ANSWER, number, Some(0), &[READ, values.len() as u8], &data)
}

/// The answer to [`Request::Write`]: what became of each.
pub fn written(number: u16, codes: &[u8]) -> Vec<u8> {
    message(ANSWER, number, Some(0), &[WRITE, codes.len() as u8], codes)
}

/// A request that is not done.
pub fn refused(number: u16, error: u16) -> Vec<u8> {
    message(ACKNOWLEDGEMENT, number, Some(error), &[], &[])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const A: Item = Item { db: 1, at: 2, len: 3 };
    const B: Item = Item { db: 2, at: 0x1_0000, len: 2 };

    /// As every description of the protocol has it.
    #[test]
    fn a_request_is_the_bytes_that_an_s7_takes() {
        let told = [0x32, 1, 0, 0, 0, 7, 0, 14, 0, 0, 4, 1, 0x12, 10, 0x10, 2, 0, 3, 0, 1, 0x84, 0, 0, 16];
        assert_eq!(read(7, A), told);
        let told = [0x32, 1, 0, 0, 0, 7, 0, 8, 0, 0, 0xF0, 0, 0, 1, 0, 1, 3, 0xC0];
        assert_eq!(setup(7, 960), told);
        let told = [
            0x32, 1, 0, 0, 0, 9, 0, 14, 0, 7, 5, 1, 0x12, 10, 0x10, 2, 0, 3, 0, 1, 0x84, 0, 0, 16, 0, 4, 0, 24, 1, 2, 3,
        ];
        assert_eq!(write(9, A, &[1, 2, 3]), told);
    }

    #[test]
    fn what_is_asked_is_what_is_understood() {
        assert_eq!(asked(&setup(1, 240)), Some((1, Request::Setup(240))));
        assert_eq!(asked(&read(2, B)), Some((2, Request::Read(vec![Some(B)]))));
        assert_eq!(asked(&write(3, A, &[1, 2, 3])), Some((3, Request::Write(vec![(Some(A), vec![1, 2, 3])]))));
        assert_eq!(write(3, A, &vec![7; write_max(240)]).len(), 240);
        // As another client asks.
        let parameters = [address(WRITE, A), address(WRITE, B)[2..].to_vec()].concat();
        let mut data = Vec::new();
        put_value(&mut data, 0, &[1, 2, 3]);
        put_value(&mut data, 0, &[4, 5]);
        let several = Request::Write(vec![(Some(A), vec![1, 2, 3]), (Some(B), vec![4, 5])]);
        assert_eq!(asked(&request(4, &parameters, &data)), Some((4, several)));
    }

    #[test]
    fn what_is_answered_is_what_is_understood() {
        assert_eq!(answer(&set_up(1, 240)), Some((1, Some(Answer::Setup(240)))));
        assert_eq!(answer(&values(2, &[Ok(vec![1, 2, 3])])), Some((2, Some(Answer::Bytes(vec![1, 2, 3])))));
        assert_eq!(answer(&values(3, &[Err(NO_OBJECT)])), Some((3, Some(Answer::NotRead(NO_OBJECT)))));
        assert_eq!(answer(&written(4, &[DONE, 5])), Some((4, Some(Answer::Written(vec![DONE, 5])))));
        assert_eq!(answer(&refused(5, NOT_AVAILABLE)), Some((5, Some(Answer::Refused(NOT_AVAILABLE)))));
        let several = values(6, &[Ok(vec![1]), Err(5), Ok(vec![2, 3])]);
        let mut found = Values(parts(&several).unwrap().data);
        let each = [found.next(), found.next(), found.next(), found.next()];
        assert_eq!(each, [Some((DONE, &[1][..])), Some((5, &[][..])), Some((DONE, &[2, 3][..])), None]);
    }

    proptest! {
        #[test]
        fn any_bytes_are_borne(kind in 0_u8..4, bytes in prop::collection::vec(any::<u8>(), 0..60)) {
            let message = [&[PROTOCOL, kind][..], &bytes].concat();
            let _ = (answer(&message), asked(&message));
        }
    }
}
