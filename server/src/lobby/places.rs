//! The places of operators: so many in all, and so many of one address. They may stay as long as they like, and must not
//! take the places of clients, or of each other.

use std::collections::BTreeMap;
use std::net::IpAddr;

/// Operators that may be in at once.
const OPERATORS_MAX: usize = 64;
/// Of them from one address.
const OPERATORS_OF_ADDRESS_MAX: usize = 16;

/// How many operators are in, by address.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Places(BTreeMap<IpAddr, usize>);

impl Places {
    /// A place for one more; false if there is none.
    pub(super) fn take(&mut self, address: IpAddr) -> bool {
        let of_address = self.0.get(&address).copied().unwrap_or(0);
        if self.0.values().sum::<usize>() >= OPERATORS_MAX || of_address >= OPERATORS_OF_ADDRESS_MAX {
            return false;
        }
        self.0.insert(address, of_address + 1);
        true
    }

    /// One has left.
    pub(super) fn give_back(&mut self, address: IpAddr) {
        debug_assert!(self.0.contains_key(&address), "an operator gives back a place that it has taken");
        if let Some(count) = self.0.get_mut(&address) {
            *count -= 1;
            if *count == 0 {
                self.0.remove(&address);
            }
        }
    }

    /// How many are in.
    pub(super) fn taken(&self) -> usize {
        self.0.values().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_address_does_not_take_all_places() {
        let address = |last: u8| IpAddr::from([10, 0, 0, last]);
        let mut places = Places::default();
        assert_eq!((0..20).filter(|_| places.take(address(1))).count(), OPERATORS_OF_ADDRESS_MAX);
        for host in 2..=4 {
            assert_eq!((0..20).filter(|_| places.take(address(host))).count(), OPERATORS_OF_ADDRESS_MAX);
        }
        assert!(!places.take(address(5)), "all are taken");
        places.give_back(address(1));
        assert!(places.take(address(5)));
        assert_eq!(places.taken(), OPERATORS_MAX);
    }
}
