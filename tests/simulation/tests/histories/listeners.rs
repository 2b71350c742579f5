//! The listeners of the program behind which others speak: the page, OPC UA, Modbus, S7, ADS, raw TCP. A crowd comes to each, on
//! virtual time: silent, slow, hasty, or clients that stay for ever; connections break, and descriptors run out. Whoever behaves as
//! a client does is served within a second, places are never more than there are, and whoever says nothing goes in time.
//!
//! What a listener allows is written here once more, as `docs/security.md` has it, so that a number that changes is noticed.

use std::cell::RefCell;
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use onescan_server::transport::accept::{Guarded, Incoming, admitted};
use onescan_server::transport::connection_limit::{ConnectionLimit, Limits};
use onescan_server::transport::listeners::{self, ListenerRules};
use onescan_simulation::chance::Chance;
use onescan_simulation::histories::{Kind, try_all};
use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream};
use tokio::sync::{Mutex, mpsc};
use tokio::task::{LocalSet, spawn_local};
use tokio::time::{Instant, sleep, sleep_until, timeout};

const KIND: Kind = Kind { name: "listeners", few: 300, share: 10 };
/// Bytes that a connection takes before somebody reads them.
const BUFFER: usize = 64;
/// A client that behaves is served within this.
const SERVED_WITHIN: Duration = Duration::from_secs(1);
/// The same where a descriptor was missing just before.
const AFTER_AN_ERROR: Duration = Duration::from_millis(150);
/// The address of all who mean to stay for ever.
const STAYING: u8 = 66;
/// How many that must leave may still be on their way.
const AT_THE_DOOR: usize = 4;
/// How long strangers come.
const CROWD: Duration = Duration::from_mins(1);

/// What `docs/security.md` says of each listener.
fn documented() -> [(ListenerRules, ListenerRules); 7] {
    let limits = |all, of_address, staying| Limits { all, of_address, staying };
    let idle = |seconds| Some(Duration::from_secs(seconds));
    let rules = |what, limits, seconds, idle| ListenerRules { what, limits, proof: Duration::from_secs(seconds), idle };
    [
        (listeners::page(None), rules("the page", limits(256, 128, 192), 30, None)),
        (listeners::page(Some(64)), rules("the page", limits(16, 8, 12), 30, None)),
        (listeners::OPC_UA, rules("OPC UA", limits(64, 32, 48), 5, idle(30))),
        (listeners::MODBUS, rules("Modbus", limits(64, 32, 48), 30, idle(600))),
        (listeners::S7, rules("S7", limits(64, 32, 48), 30, idle(600))),
        (listeners::INSPECTION, rules("ADS", limits(24, 12, 18), 30, idle(600))),
        (listeners::RAW_TCP, rules("raw TCP", limits(16, 8, 12), 600, idle(600))),
    ]
}

#[test]
fn each_listener_allows_what_is_documented() {
    for (rules, documented) in documented() {
        assert_eq!(rules, documented);
    }
    assert_eq!((listeners::ADS.limits, listeners::ADS.proof), (listeners::S7.limits, listeners::S7.proof));
    assert_eq!(listeners::PLC, Limits { all: 1, of_address: 1, staying: 1 });
    // However few descriptors there are, somebody can look.
    assert_eq!(listeners::page(Some(0)).limits, Limits { all: 8, of_address: 4, staying: 6 });
    assert_eq!(listeners::page(Some(4 * 100)).limits.all, 100);
}

/// Connections that come on virtual time.
struct Network(Mutex<mpsc::Receiver<io::Result<(DuplexStream, SocketAddr)>>>);

impl Incoming for Network {
    type Stream = DuplexStream;

    async fn accept(&self) -> io::Result<(DuplexStream, SocketAddr)> {
        match self.0.lock().await.recv().await {
            Some(came) => came,
            None => std::future::pending().await,
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Manner {
    Silent,
    /// A byte now and then, and never a whole request.
    Slow,
    /// Asks again and again, and does not read.
    Deaf,
    /// Asks and goes.
    Brief,
    /// Comes and goes at once.
    Gone,
    /// Proves to be a client, and stays for ever.
    Staying,
}

const MANNERS: [Manner; 6] = [Manner::Silent, Manner::Slow, Manner::Deaf, Manner::Brief, Manner::Gone, Manner::Staying];

/// What is seen of a listener.
struct Seen {
    rules: ListenerRules,
    limit: ConnectionLimit,
    /// Connections that stay.
    staying: usize,
    /// Those that are served, one that must leave until it is looked at.
    served: usize,
    broken: Option<String>,
    begun: Instant,
    /// Of what was seen when.
    trace: blake3::Hasher,
}

impl Seen {
    fn breaks(&mut self, why: String) {
        self.broken.get_or_insert(why);
    }

    fn look(&mut self) {
        let (Limits { all, of_address: _, staying }, count) = (self.rules.limits, self.limit.count());
        let moment = (self.begun.elapsed().as_micros() as u64, count as u64, self.staying as u64);
        for number in [moment.0, moment.1, moment.2] {
            self.trace.update(&number.to_le_bytes());
        }
        if self.served > all + AT_THE_DOOR {
            self.breaks(format!("{} connections are served", self.served));
        }
        if count > all || self.staying > staying {
            self.breaks(format!("{count} connections are there, and {} of them stay", self.staying));
        }
    }
}

type Shared = Rc<RefCell<Seen>>;

/// Takes connections and serves each.
async fn listen(network: Network, seen: Shared) {
    let (rules, limit) = { (seen.borrow().rules, seen.borrow().limit.clone()) };
    loop {
        let came = admitted(&network, &limit, rules.what).await;
        seen.borrow_mut().look();
        let guarded = Guarded::new(came.stream, came.place, came.leaving, rules.proof).idle_for(rules.idle);
        let (served, watched) = (spawn_local(serve(guarded, Rc::clone(&seen))), Rc::clone(&seen));
        spawn_local(async move {
            if served.await.is_err() {
                watched.borrow_mut().breaks("the service of a connection has panicked".to_owned());
            }
        });
    }
}

/// Answers requests: `g` is answered, `v` makes the connection one that stays.
async fn serve(mut guarded: Guarded<DuplexStream>, seen: Shared) {
    let (pass, mut stays) = (guarded.pass(), false);
    let mut byte = [0];
    seen.borrow_mut().served += 1;
    while matches!(guarded.read(&mut byte).await, Ok(1)) {
        let answer = match byte {
            [b'v'] if pass.stay() => {
                seen.borrow_mut().staying += usize::from(!std::mem::replace(&mut stays, true));
                b'y'
            }
            [b'v'] => b'n',
            [b'g'] => b'a',
            _ => continue,
        };
        seen.borrow_mut().look();
        if guarded.write_all(&[answer]).await.is_err() {
            break;
        }
    }
    // Whoever asks a connection that has ended hears again that it has: libraries do ask.
    let _ = guarded.read(&mut byte).await;
    // It may be gone already.
    let _ = guarded.shutdown().await;
    let mut seen = seen.borrow_mut();
    seen.served -= 1;
    seen.staying -= usize::from(stays);
}

/// One crowd at one listener.
struct Crowd {
    network: mpsc::Sender<io::Result<(DuplexStream, SocketAddr)>>,
    seen: Shared,
    number: u16,
}

impl Crowd {
    async fn connect(&mut self, from: u8) -> Option<DuplexStream> {
        let (own, other) = tokio::io::duplex(BUFFER);
        self.number = self.number.wrapping_add(1);
        let address = SocketAddr::new(IpAddr::from([10, 0, 0, from]), self.number);
        self.network.send(Ok((other, address))).await.ok()?;
        Some(own)
    }
}

/// What a stranger does with its connection until `until`.
async fn strange(mut stream: DuplexStream, manner: Manner, until: Instant, seen: Shared) {
    let patience = seen.borrow().rules.proof;
    match manner {
        Manner::Gone => {}
        Manner::Brief => {
            // It may be closed already.
            let _ = stream.write_all(b"g").await;
            let _ = stream.read(&mut [0]).await;
        }
        Manner::Silent => drop(timeout(until - Instant::now(), stream.read(&mut [0])).await),
        Manner::Slow => {
            while Instant::now() < until && stream.write_all(b".").await.is_ok() {
                sleep(patience / 7).await;
            }
        }
        Manner::Deaf => {
            while Instant::now() < until {
                match timeout(2 * patience, stream.write_all(b"g")).await {
                    Ok(Ok(())) => {}
                    Ok(Err(_)) => break,
                    Err(_) => {
                        seen.borrow_mut().breaks("one that does not read its answers keeps its place".to_owned());
                        break;
                    }
                }
            }
        }
        Manner::Staying => {
            if stream.write_all(b"v").await.is_ok() {
                let mut answer = [0];
                let _ = stream.read(&mut answer).await;
                sleep_until(until).await;
            }
        }
    }
}

/// Whoever behaves as a client does: connects, asks at once, and is answered in time. `is_client` asks to stay, and gives that up
/// after `stays`.
async fn behave(
    stream: Option<DuplexStream>,
    (asks, expected): (u8, u8),
    (within, stays): (Duration, Duration),
) -> Result<(), String> {
    let Some(mut stream) = stream else { return Err("the listener takes no connection any more".to_owned()) };
    let begun = Instant::now();
    let mut answer = [0];
    let served = async {
        stream.write_all(&[asks]).await?;
        stream.read_exact(&mut answer).await
    };
    match timeout(within, served).await {
        Ok(Ok(_)) if answer == [expected] => {}
        other => return Err(format!("a client was answered {other:?} {answer:?} after {:?}", begun.elapsed())),
    }
    // Once it has its place, silence costs it nothing.
    sleep(stays).await;
    let again = async {
        stream.write_all(b"g").await?;
        stream.read_exact(&mut answer).await
    };
    match timeout(SERVED_WITHIN, again).await {
        Ok(Ok(_)) if answer == *b"a" => Ok(()),
        other => Err(format!("a client with a place was answered {other:?} {stays:?} later")),
    }
}

async fn crowded(mut chance: Chance, rules: ListenerRules) -> Result<u64, String> {
    let limit = ConnectionLimit::new(rules.limits);
    let seen: Shared = Rc::new(RefCell::new(Seen {
        rules,
        limit: limit.clone(),
        staying: 0,
        served: 0,
        begun: Instant::now(),
        broken: None,
        trace: blake3::Hasher::new(),
    }));
    let (send, receive) = mpsc::channel(1);
    spawn_local(listen(Network(Mutex::new(receive)), Rc::clone(&seen)));
    let (begun, until) = (Instant::now(), Instant::now() + CROWD);
    let mut crowd = Crowd { network: send, seen: Rc::clone(&seen), number: 0 };
    // Those who mean to stay come from one address: that must not have all places.
    let count = if chance.one_in(16) { 1_000 } else { chance.below(3 * rules.limits.all as u64) };
    let only = chance.one_in(2).then(|| MANNERS[chance.below(6) as usize]);
    let mut strangers: Vec<(Duration, Manner, u8)> = (0..count)
        .map(|_| {
            let manner = MANNERS[chance.below(6) as usize];
            let manner = only.unwrap_or(manner);
            let from = if matches!(manner, Manner::Staying) { STAYING } else { 60 + chance.below(6) as u8 };
            (chance.within_ms(CROWD.as_millis() as u64), manner, from)
        })
        .collect();
    strangers.sort_by_key(|(at, ..)| *at);
    let mut clients: Vec<Duration> =
        (0..=chance.below(4)).map(|_| chance.within_ms(CROWD.as_millis() as u64)).collect();
    clients.sort();
    let mut behaving = Vec::new();
    for (at, manner, from) in strangers {
        while let Some(due) = clients.first().copied().filter(|due| *due <= at) {
            clients.remove(0);
            behaving.push(comes(&mut crowd, &mut chance, begun + due).await);
        }
        sleep_until(begun + at).await;
        if chance.one_in(50) {
            crowd.network.send(Err(io::Error::from_raw_os_error(24))).await.map_err(|_| "the listener has ended")?;
            // Once there are descriptors again, nobody waits for longer than a moment.
            let waiting = crowd.connect(1).await;
            behaving.push(spawn_local(behave(waiting, (b'g', b'a'), (AFTER_AN_ERROR, Duration::ZERO))));
        }
        if let Some(stream) = crowd.connect(from).await {
            spawn_local(strange(stream, manner, until, Rc::clone(&seen)));
        }
    }
    for due in clients {
        behaving.push(comes(&mut crowd, &mut chance, begun + due).await);
    }
    for client in behaving {
        client.await.map_err(|error| error.to_string())??;
    }
    // All strangers have gone, and whoever still says nothing has no place any more.
    sleep_until(until + rules.proof + Duration::from_secs(1)).await;
    leaves_in_time(&mut crowd, &limit, b"", rules.proof).await?;
    if let Some(idle) = rules.idle {
        leaves_in_time(&mut crowd, &limit, b"v", idle).await?;
    }
    let mut seen = seen.borrow_mut();
    match seen.broken.take() {
        Some(broken) => Err(broken),
        None => Ok(u64::from_le_bytes(seen.trace.finalize().as_bytes()[..8].try_into().expect("eight bytes"))),
    }
}

/// One that says no more than this is there as long as it may be, and no longer.
async fn leaves_in_time(
    crowd: &mut Crowd,
    limit: &ConnectionLimit,
    says: &[u8],
    after: Duration,
) -> Result<(), String> {
    let mut quiet = crowd.connect(70).await.ok_or("the listener takes no connection any more")?;
    quiet.write_all(says).await.map_err(|error| error.to_string())?;
    let moment = Duration::from_millis(1);
    sleep_until(Instant::now() + after - moment).await;
    let early = limit.count();
    sleep(2 * moment).await;
    tokio::task::yield_now().await;
    let late = limit.count();
    if (early, late) == (1, 0) {
        return Ok(());
    }
    Err(format!("one that said {says:?}: {early} connections before its time was over, {late} after it"))
}

/// A client comes at `due`, and behaves.
async fn comes(crowd: &mut Crowd, chance: &mut Chance, due: Instant) -> tokio::task::JoinHandle<Result<(), String>> {
    sleep_until(due).await;
    let rules = crowd.seen.borrow().rules;
    let is_staying = chance.one_in(2);
    let stays = if is_staying {
        rules.idle.map_or(2 * rules.proof, |idle| (2 * rules.proof).min(idle / 2))
    } else {
        Duration::ZERO
    };
    let asks = if is_staying { (b'v', b'y') } else { (b'g', b'a') };
    // Whoever only asks may be beside those who mean to stay for ever.
    let from = if !is_staying && chance.one_in(2) { STAYING } else { 1 };
    let stream = crowd.connect(from).await;
    spawn_local(behave(stream, asks, (SERVED_WITHIN, stays)))
}

fn history(seed: u64) -> Result<u64, String> {
    let mut chance = Chance::new(seed);
    let (_, rules) = documented()[chance.below(7) as usize];
    let runtime =
        tokio::runtime::Builder::new_current_thread().enable_time().start_paused(true).build().expect("a runtime");
    LocalSet::new().block_on(&runtime, crowded(chance, rules)).map_err(|wrong| format!("{wrong}, at {}", rules.what))
}

#[test]
fn a_client_is_served_in_any_crowd() {
    try_all(KIND, history);
}

/// A listener that is shared by threads, as those of real PLCs are: what one that leaves does is done once.
#[test]
fn whoever_must_leave_is_asked_once() {
    try_all(Kind { name: "places", few: 2_000, share: 5 }, |seed| {
        let mut chance = Chance::new(seed);
        let limits = Limits {
            all: 1 + chance.below(6) as usize,
            of_address: 1 + chance.below(4) as usize,
            staying: 1 + chance.below(4) as usize,
        };
        let limit = ConnectionLimit::new(limits);
        let asked = Arc::new(std::sync::Mutex::new(Vec::new()));
        let mut there: Vec<(u64, u8, onescan_server::transport::connection_limit::Place, bool)> = Vec::new();
        for number in 0..chance.below(60) {
            let from = chance.below(3) as u8;
            let leave = Arc::clone(&asked);
            match limit.admit(IpAddr::from([10, 0, 0, from]), move || leave.lock().expect("one thread").push(number)) {
                Some(place) => there.push((number, from, place, false)),
                None if there.iter().any(|(.., stays)| !stays)
                    && there.iter().filter(|(_, of, ..)| *of == from).count() < limits.of_address =>
                {
                    return Err(format!("number {number} finds no place beside {}", there.len()));
                }
                None => {}
            }
            let gone: Vec<u64> = std::mem::take(&mut *asked.lock().expect("one thread"));
            for gone in &gone {
                let at = there
                    .iter()
                    .position(|(number, ..)| number == gone)
                    .ok_or("one is asked twice, or is not there")?;
                let (_, of, place, stays) = there.remove(at);
                if stays || place.stay() {
                    return Err(format!("number {gone} stays, and must leave"));
                }
                let first = there
                    .iter()
                    .filter(|(other, by, _, stays)| !stays && other < gone && (*by == of || *by == from))
                    .count();
                if first > 0
                    && there.iter().any(|(other, by, _, stays)| !stays && other < gone && *by == from && of == from)
                {
                    return Err(format!("number {gone} must leave before one that came earlier"));
                }
            }
            if gone.len() > 1 {
                return Err("more than one must leave for one".to_owned());
            }
            if let Some(last) = there.last_mut().filter(|_| chance.one_in(3)) {
                last.3 = last.2.stay();
            }
            if chance.one_in(4) && !there.is_empty() {
                let at = chance.below(there.len() as u64) as usize;
                drop(there.remove(at));
            }
            let staying = there.iter().filter(|(.., stays)| *stays).count();
            if limit.count() != there.len() || there.len() > limits.all || staying > limits.staying {
                return Err(format!(
                    "{} places are taken, and {} are there, of which {staying} stay",
                    limit.count(),
                    there.len()
                ));
            }
            for address in 0..3 {
                if there.iter().filter(|(_, of, ..)| *of == address).count() > limits.of_address {
                    return Err("an address has more than its share".to_owned());
                }
                // Three quarters of an address' places, and one at least, may be taken for good.
                let stay = there.iter().filter(|(_, of, _, stays)| *of == address && *stays).count();
                if stay > (limits.of_address * 3 / 4).max(1) {
                    return Err(format!("{stay} of one address stay"));
                }
            }
        }
        Ok(limit.count() as u64)
    });
}
