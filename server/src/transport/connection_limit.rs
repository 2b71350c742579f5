//! How many connections a listener keeps at a time, and which of them is closed for one that comes.
//!
//! One that has proved to be a client's stays. All others give way, the longest there first, so that strangers who say
//! nothing keep nobody out, however many they are: one that comes and speaks has spoken before others push it out.

use std::collections::BTreeMap;
use std::fmt;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::oneshot;

/// How many connections a listener keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Of all addresses together.
    pub all: usize,
    /// Of one IP address.
    pub of_address: usize,
    /// Of those that stay.
    pub staying: usize,
}

impl Limits {
    /// Of those that stay, how many may be of one address: its others have room beside them.
    fn staying_of_address(self) -> usize {
        (self.of_address * 3 / 4).max(1)
    }
}

/// The connections of a listener. Clones are of the same listener.
#[derive(Clone)]
pub struct ConnectionLimit(Arc<Mutex<Present>>);

struct Present {
    limits: Limits,
    next: u64,
    /// In the order in which they came.
    connections: BTreeMap<u64, Connection>,
}

struct Connection {
    address: IpAddr,
    stays: bool,
    leave: Box<dyn FnOnce() + Send>,
}

/// The place of a connection among those of its listener; it is free again when this is dropped.
pub struct Place {
    limit: ConnectionLimit,
    number: u64,
}

impl fmt::Debug for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Place").field(&self.number).finish()
    }
}

impl ConnectionLimit {
    /// The limit of a listener without connections.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        Self(Arc::new(Mutex::new(Present { limits, next: 0, connections: BTreeMap::new() })))
    }

    fn lock(&self) -> MutexGuard<'_, Present> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets a connection in. Where there is no room, the one that came first of those that do not stay must leave, of
    /// the same address if that has its share: its `leave` is called, once. Nothing if all of them stay.
    pub fn admit(&self, address: IpAddr, leave: impl FnOnce() + Send + 'static) -> Option<Place> {
        let mut present = self.lock();
        let Limits { all, of_address, staying: _ } = present.limits;
        let of_same = present.connections.values().filter(|connection| connection.address == address).count();
        let leaving = if of_same >= of_address {
            Some(present.first(|connection| connection.address == address)?)
        } else if present.connections.len() >= all {
            Some(present.first(|_| true)?)
        } else {
            None
        };
        let leaving = leaving.and_then(|number| present.connections.remove(&number));
        let number = present.next;
        present.next += 1;
        present.connections.insert(number, Connection { address, stays: false, leave: Box::new(leave) });
        debug_assert!(present.connections.len() <= all.max(1), "one leaves for one who comes");
        // Whoever leaves may give its place back at once.
        drop(present);
        if let Some(connection) = leaving {
            (connection.leave)();
        }
        Some(Place { limit: self.clone(), number })
    }

    /// The same for a connection of a task, which waits for the word that it must leave.
    pub fn admit_task(&self, address: IpAddr) -> Option<(Place, oneshot::Receiver<()>)> {
        let (leave, leaving) = oneshot::channel();
        let place = self.admit(address, move || {
            // It may have gone by itself.
            leave.send(()).ok();
        });
        place.map(|place| (place, leaving))
    }

    /// How many connections there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.lock().connections.len()
    }
}

impl Present {
    /// The first of those that do not stay.
    fn first(&self, accept: impl Fn(&Connection) -> bool) -> Option<u64> {
        self.connections
            .iter()
            .find(|(_, connection)| !connection.stays && accept(connection))
            .map(|(number, _)| *number)
    }
}

impl Place {
    /// From now on the connection leaves for nobody. False if it had to leave already, or too many stay.
    #[must_use]
    pub fn stay(&self) -> bool {
        let mut present = self.limit.lock();
        let Some(address) = present.connections.get(&self.number).map(|connection| connection.address) else {
            return false;
        };
        let staying = present.connections.values().filter(|connection| connection.stays);
        let (all, of_same) =
            staying.fold((0, 0), |(all, same), other| (all + 1, same + usize::from(other.address == address)));
        let is_full = all >= present.limits.staying || of_same >= present.limits.staying_of_address();
        match present.connections.get_mut(&self.number) {
            Some(connection) => {
                connection.stays |= !is_full;
                connection.stays
            }
            None => false,
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        // One that had to leave is not there any more.
        self.limit.lock().connections.remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    const LIMITS: Limits = Limits { all: 4, of_address: 3, staying: 4 };

    fn address(last: u8) -> IpAddr {
        IpAddr::from([10, 0, 0, last])
    }

    /// A limit, and who had to leave.
    struct Watched {
        limit: ConnectionLimit,
        left: mpsc::Receiver<u8>,
        leave: mpsc::Sender<u8>,
    }

    impl Watched {
        fn new() -> Self {
            let (leave, left) = mpsc::channel();
            Self { limit: ConnectionLimit::new(LIMITS), left, leave }
        }

        fn admit(&self, from: u8, name: u8) -> Option<Place> {
            let leave = self.leave.clone();
            self.limit.admit(address(from), move || leave.send(name).unwrap())
        }

        fn left(&self) -> Vec<u8> {
            self.left.try_iter().collect()
        }
    }

    #[test]
    fn the_first_of_an_address_leaves_when_that_has_its_share() {
        let watched = Watched::new();
        let other = watched.admit(1, 0).unwrap();
        let first: Vec<_> = (1..=3).map(|name| watched.admit(2, name).unwrap()).collect();
        assert!(watched.left().is_empty());
        let fourth = watched.admit(2, 4).unwrap();
        assert_eq!(watched.left(), [1]);
        assert!(!first[0].stay() && first[1].stay() && fourth.stay() && other.stay());
        drop(first);
        assert_eq!(watched.limit.count(), 2, "one that had to leave gives back no other's place");
    }

    #[test]
    fn the_first_of_all_leaves_when_all_places_are_taken() {
        let watched = Watched::new();
        let places: Vec<_> = (0..4).map(|name| watched.admit(name, name).unwrap()).collect();
        assert!(places[0].stay());
        let _last = watched.admit(9, 9).unwrap();
        assert_eq!((watched.left(), watched.limit.count()), (vec![1], 4));
    }

    #[test]
    fn who_stays_leaves_for_nobody() {
        let watched = Watched::new();
        let places: Vec<_> = (0..4).map(|name| watched.admit(name, name).unwrap()).collect();
        assert!(places.iter().all(Place::stay));
        assert!(watched.admit(9, 9).is_none());
        drop(places);
        assert!(watched.admit(9, 9).is_some());
        assert!(watched.left().is_empty());
    }

    #[test]
    fn no_more_stay_than_may() {
        let limit = ConnectionLimit::new(Limits { staying: 1, ..LIMITS });
        let [first, second] = [1, 2].map(|from| limit.admit(address(from), || ()).unwrap());
        assert!(first.stay() && first.stay() && !second.stay());
        drop(first);
        assert!(second.stay());
    }

    #[test]
    fn whoever_leaves_may_drop_its_place_at_once() {
        let limit = ConnectionLimit::new(Limits { all: 1, of_address: 1, staying: 1 });
        let kept = Arc::new(Mutex::new(None::<Place>));
        let own = Arc::clone(&kept);
        let place = limit.admit(address(1), move || drop(own.lock().unwrap().take())).unwrap();
        *kept.lock().unwrap() = Some(place);
        let _next = limit.admit(address(1), || ()).unwrap();
        assert!(kept.lock().unwrap().is_none());
        assert_eq!(limit.count(), 1);
    }
}
