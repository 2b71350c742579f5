//! Steps a second in lockstep with two clients, each beside a raw reference of the same run: function
//! calls beside a bare loop of calls, TCP beside a bare ping-pong of the same bytes.
//!
//! `cargo bench -p onescan-tests --bench lockstep`

use std::hint::black_box;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput};
use onescan_server::client::Client;
use onescan_server::lockstep::Lockstep;
use onescan_server::time::VirtualTime;
use onescan_tests::bench::{Ledger, two_carriers};
use onescan_tests::run::{PATIENCE, boxed, in_process, loopback, over_tcp};

/// Bytes of a frame before its inputs: length, type, sequence, time.
const GRANT_HEADER_BYTES: usize = 21;
/// Bytes of a frame before its outputs: those, and the wake-up.
const TURN_HEADER_BYTES: usize = 29;

/// Runs `steps` steps of a session that has been set up, and takes the time.
fn timed(lockstep: &mut Lockstep, steps: u64) -> Duration {
    lockstep.run_to(VirtualTime::ZERO).expect("nothing is recorded");
    let until = VirtualTime::from_nanos(lockstep.session().t_v().as_nanos() + steps * 1_000_000);
    let started = Instant::now();
    lockstep.run_to(until).expect("nothing is recorded");
    started.elapsed()
}

/// Two clients called in a loop, their bytes copied to and fro, and nothing else.
fn bare_calls(bytes: usize, steps: u64) -> Duration {
    let (_, carriers) = two_carriers(bytes);
    let mut clients: Vec<Box<dyn Client>> = boxed(carriers);
    let mut buffers = [vec![0; bytes], vec![0; bytes]];
    let started = Instant::now();
    for step in 1..=steps {
        let t_v = VirtualTime::from_nanos(step);
        let [one, two] = &mut buffers;
        let _ = black_box(clients[0].turn(t_v, black_box(two), one));
        let _ = black_box(clients[1].turn(t_v, black_box(one), two));
    }
    started.elapsed()
}

/// Two connections; the same bytes as a grant and a turn go to and fro on both in every step.
fn bare_ping_pong(bytes: usize, steps: u64) -> Duration {
    let listener = TcpListener::bind(loopback()).expect("a free port");
    let address = listener.local_addr().expect("bound");
    let (grant, turn) = (GRANT_HEADER_BYTES + bytes, TURN_HEADER_BYTES + bytes);
    let echo = move || {
        let mut stream = TcpStream::connect(address).expect("somebody listens");
        stream.set_nodelay(true).expect("a socket");
        let (mut input, output) = (vec![0; grant], vec![0; turn]);
        while stream.read_exact(&mut input).is_ok() {
            stream.write_all(&output).expect("connected");
        }
    };
    let threads = [std::thread::spawn(echo), std::thread::spawn(echo)];
    let mut streams = [0, 1].map(|_| listener.accept().expect("both connect").0);
    for stream in &streams {
        stream.set_nodelay(true).expect("a socket");
    }
    let (output, mut input) = (vec![0; grant], vec![0; turn]);
    let started = Instant::now();
    for _ in 0..steps {
        for stream in &mut streams {
            stream.write_all(&output).expect("connected");
        }
        for stream in &mut streams {
            stream.read_exact(&mut input).expect("connected");
        }
    }
    let elapsed = started.elapsed();
    drop(streams);
    for thread in threads {
        thread.join().expect("no panic");
    }
    elapsed
}

fn lockstep_calls(bytes: usize, steps: u64) -> Duration {
    let (plan, carriers) = two_carriers(bytes);
    timed(&mut in_process(plan, boxed(carriers)), steps)
}

fn lockstep_tcp(bytes: usize, steps: u64) -> Duration {
    let (plan, carriers) = two_carriers(bytes);
    let (mut lockstep, threads) = over_tcp(plan, boxed(carriers), PATIENCE);
    let elapsed = timed(&mut lockstep, steps);
    lockstep.set_until(Some(VirtualTime::ZERO));
    lockstep.run().expect("nothing is recorded");
    for thread in threads {
        thread.join().expect("no panic").expect("a good end");
    }
    elapsed
}

/// A case: what it is called, how many bytes each way, how it is run.
type Case = (&'static str, usize, fn(usize, u64) -> Duration);

const CASES: [Case; 8] = [
    ("inproc, empty", 0, lockstep_calls),
    ("bare calls, empty", 0, bare_calls),
    ("inproc, 300 bytes", 300, lockstep_calls),
    ("bare calls, 300 bytes", 300, bare_calls),
    ("tcp, empty", 0, lockstep_tcp),
    ("bare ping-pong, empty", 0, bare_ping_pong),
    ("tcp, 300 bytes", 300, lockstep_tcp),
    ("bare ping-pong, 300 bytes", 300, bare_ping_pong),
];

fn main() {
    let ledger = Ledger::default();
    let mut criterion = Criterion::default().configure_from_args().sample_size(20);
    let mut group = criterion.benchmark_group("lockstep");
    group.throughput(Throughput::Elements(1));
    for (what, bytes, run) in CASES {
        group.bench_function(BenchmarkId::from_parameter(what), |bencher| {
            bencher.iter_custom(|steps| {
                let time = run(bytes, steps);
                ledger.note(what, time, steps);
                time
            });
        });
    }
    group.finish();
    criterion.final_summary();
    for pair in CASES.chunks_exact(2) {
        ledger.compare(pair[0].0, pair[1].0);
    }
}
