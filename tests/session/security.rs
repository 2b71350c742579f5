//! Sessions over TLS with tokens: who is let in, who is not and why, and that nobody who is sent away leaves a trace.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::thread::JoinHandle;

use onescan_runner::access::certificate;
use onescan_runner::access::folder::{AUTHORITY, CLIENTS, Folder};
use onescan_server::access::{Day, Fingerprint, Pass, Register, RevocationList, Revoked, Role, Token};
use onescan_server::formation::Formation;
use onescan_server::lockstep::{Lockstep, Outcome};
use onescan_server::mailbox::{Mailbox, Wish};
use onescan_server::operation::{Control, Operation};
use onescan_server::plan::Coupling;
use onescan_server::transport::tcp::operator::{OperatorConnection, operate};
use onescan_server::transport::tcp::participant::take_part;
use onescan_server::transport::tcp::{Entrance, House, Lobby};
use onescan_server::transport::tls::{Trust, first_certificate};
use onescan_tests::at_ms;
use onescan_tests::run::{Fate, PATIENCE, boxed, in_process, loopback, run};
use onescan_tests::toy::{RING, ring, ring_plan};

use crate::wire::{HELLO, frame, send};

/// A folder with a certificate, and whom those trust who have its authority.
fn certified() -> (tempfile::TempDir, Trust) {
    let place = tempfile::tempdir().expect("a folder");
    let folder = Folder(place.path());
    certificate::new(folder, &[], onescan_runner::access::tokens::today(), 30).expect("a certificate");
    let trust = Trust::from_pem(&std::fs::read(folder.file(AUTHORITY)).expect("written")).expect("an authority");
    (place, trust)
}

/// Tokens of the ring's clients, and of others.
struct Tokens {
    register: Register,
    clients: Vec<Token>,
    operator: Token,
    viewer: Token,
    expired: Token,
}

fn tokens() -> Tokens {
    let mut register = Register::default();
    let mut made = |name: &str, role: &str, expires: Option<Day>| {
        let (token, role) = (Token::generate().expect("random numbers"), role.parse::<Role>().expect("a role"));
        register.add(Pass { name: name.to_owned(), role, expires, hash: token.hash() }).expect("a name of its own");
        token
    };
    let clients = RING.map(|(name, _)| made(name, &format!("client:{name}"), None)).to_vec();
    let (operator, viewer) = (made("anna", "operator", None), made("wall", "viewer", None));
    let expired = made("old", "operator", Some(Day::EPOCH));
    Tokens { register, clients, operator, viewer, expired }
}

/// A session of the ring over TLS, ready to run, with everybody's way in.
struct Secured {
    lobby: Lobby,
    lockstep: Lockstep,
    threads: Vec<JoinHandle<Fate>>,
    tokens: Tokens,
    trust: Trust,
    mailbox: Mailbox,
}

impl Secured {
    fn new() -> Self {
        let (place, trust) = certified();
        let tokens = tokens();
        let identity = Folder(place.path()).identity().expect("it can be used");
        let house = House { register: Some(tokens.register.clone()), identity, revocations: None };
        let (plan, mailbox) = (ring_plan(&Coupling::Parallel), Mailbox::new());
        let lobby = Lobby::open_house(loopback(), &plan, mailbox.clone(), house).expect("a free port");
        let address = lobby.address();
        let part = |(mut client, token): (Box<dyn onescan_server::client::Client>, &Token)| {
            let entrance = Entrance { address, token: Some(token.clone()), trust: Some(trust.clone()) };
            std::thread::spawn(move || take_part(client.as_mut(), entrance))
        };
        let threads = boxed(ring()).into_iter().zip(&tokens.clients).map(part).collect();
        let mut formation = Formation::new(plan);
        formation.set_mailbox(mailbox.clone());
        formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |_| true).expect("all come");
        let mut lockstep = formation.start().expect("all have joined");
        lockstep.set_mailbox(mailbox.clone());
        Self { lobby, lockstep, threads, tokens, trust, mailbox }
    }

    fn address(&self) -> SocketAddr {
        self.lobby.address()
    }

    fn entrance(&self, token: Option<&Token>) -> Entrance {
        Entrance { address: self.address(), token: token.cloned(), trust: Some(self.trust.clone()) }
    }

    /// Runs to the end; all clients hear the same.
    fn ends(self) -> Outcome {
        let outcome = run(self.lockstep, at_ms(200));
        for thread in self.threads {
            assert_eq!(thread.join().expect("no panic").expect("it has taken part"), outcome.end);
        }
        outcome
    }
}

fn undisturbed() -> Outcome {
    run(in_process(ring_plan(&Coupling::Parallel), boxed(ring())), at_ms(200))
}

#[test]
fn over_tls_with_tokens_the_digest_is_the_same() {
    assert_eq!(Secured::new().ends(), undisturbed());
}

/// What an operator with this entrance hears.
fn asked(entrance: Entrance) -> String {
    match operate(entrance, Some(Operation::from(Control::Pause)), PATIENCE) {
        Ok(status) => format!("let in: {status:?}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn whoever_is_sent_away_hears_why_and_leaves_no_trace() {
    let session = Secured::new();
    let stranger = certified().1;
    let unknown = Token::generate().expect("random numbers");
    let strange = Entrance { trust: Some(stranger), ..session.entrance(Some(&session.tokens.operator)) };
    let plain = Entrance { trust: None, ..session.entrance(Some(&session.tokens.operator)) };
    for (entrance, why) in [
        (session.entrance(None), "lets nobody in without a token"),
        (session.entrance(Some(&unknown)), "the token is not one of this session's"),
        (session.entrance(Some(&session.tokens.expired)), "token `old` expired: its last day was 1970-01-01"),
        (
            session.entrance(Some(&session.tokens.clients[0])),
            "token `alpha` is good for `client:alpha`, not to be an operator",
        ),
        (session.entrance(Some(&session.tokens.viewer)), "token `wall` lets its holder look, and change nothing"),
        (strange, "its certificate is a stranger's: no trusted authority has signed it"),
        (plain, "this session speaks TLS only"),
    ] {
        let said = asked(entrance);
        assert!(said.contains(why), "{why:?} is not in {said:?}");
    }
    assert!(session.mailbox.is_empty(), "nothing of it has reached the session");
    assert_eq!(session.ends(), undisturbed());
}

/// `ClientHello` of TLS 1.1: a version of 3.2, one way of encryption, one way of signing.
fn hello_of_tls_1_1() -> Vec<u8> {
    let mut body = vec![3, 2];
    body.extend([7; 32]);
    body.extend([0, 0, 2, 0, 0x2f, 1, 0]);
    body.extend([0, 8, 0, 13, 0, 4, 0, 2, 4, 3]);
    let mut message = vec![1, 0, 0, body.len() as u8];
    message.extend(body);
    let mut record = vec![0x16, 3, 1, 0, message.len() as u8];
    record.extend(message);
    record
}

#[test]
fn an_old_version_of_tls_is_refused_by_name() {
    let session = Secured::new();
    let mut stream = TcpStream::connect(session.address()).expect("it listens");
    stream.set_read_timeout(Some(PATIENCE)).expect("a time-out");
    stream.write_all(&hello_of_tls_1_1()).expect("it takes them");
    let mut answer = Vec::new();
    // It may be reset after its last word.
    let _ = stream.read_to_end(&mut answer);
    // A fatal alert of type 70: `protocol_version`.
    assert!(answer.starts_with(&[0x15, 3]) && answer.get(5..7) == Some(&[2, 70]), "{answer:?}");
    assert_eq!(session.ends(), undisturbed());
}

#[test]
fn tls_where_there_is_none_is_refused() {
    let plan = ring_plan(&Coupling::Parallel);
    let lobby = Lobby::open(loopback(), &plan, Mailbox::new()).expect("a free port");
    let entrance = Entrance { address: lobby.address(), token: None, trust: Some(certified().1) };
    let said = asked(entrance);
    assert!(said.contains("the other side does not speak TLS"), "{said}");
    let said = send(lobby.address(), &hello_of_tls_1_1());
    assert!(said.contains("it speaks TLS, and this session has no certificate"), "{said}");
}

#[test]
fn a_token_is_good_for_its_own_client_only() {
    let tokens = tokens();
    let house = House { register: Some(tokens.register), ..House::default() };
    let plan = ring_plan(&Coupling::Parallel);
    let lobby = Lobby::open_house(loopback(), &plan, Mailbox::new(), house).expect("a free port");
    let with = |token: &Token| HELLO.replace("\"agent\"", &format!("\"token\":\"{}\",\"agent\"", token.reveal()));
    let beta =
        r#"{"join":{"name":"beta","period_ns":20000000,"reads":[],"writes":[{"name":"beta.out","type":"ULINT"}]}}"#;
    let said = send(lobby.address(), &[frame(&with(&tokens.clients[0])), frame(beta)].concat());
    assert!(said.contains("token `alpha` is good for `client:alpha`, not for client `beta`"), "{said}");
    let said = send(lobby.address(), &[frame(&with(&tokens.viewer)), frame(beta)].concat());
    assert!(said.contains("token `wall` is good for `viewer`, not to be a client"), "{said}");
}

/// An authority for clients, and the certificates that it gives.
struct Authority {
    issuer: rcgen::Issuer<'static, rcgen::KeyPair>,
    pem: String,
}

impl Authority {
    fn new() -> Self {
        let mut params = rcgen::CertificateParams::default();
        params.distinguished_name.push(rcgen::DnType::CommonName, "the plant's authority");
        params.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
        let key = rcgen::KeyPair::generate().expect("random numbers");
        let pem = params.self_signed(&key).expect("a certificate").pem();
        Self { issuer: rcgen::Issuer::new(params, key), pem }
    }

    /// Certificate and key of `name` in `unit`, good up to this year.
    fn gives(&self, name: &str, unit: Option<&str>, last_year: i32) -> (String, String) {
        let mut params = rcgen::CertificateParams::default();
        params.distinguished_name = rcgen::DistinguishedName::new();
        params.distinguished_name.push(rcgen::DnType::OrganizationName, "the plant");
        if let Some(unit) = unit {
            params.distinguished_name.push(rcgen::DnType::OrganizationalUnitName, unit);
        }
        params.distinguished_name.push(rcgen::DnType::CommonName, name);
        params.extended_key_usages = vec![rcgen::ExtendedKeyUsagePurpose::ClientAuth];
        (params.not_before, params.not_after) =
            (rcgen::date_time_ymd(2020, 1, 1), rcgen::date_time_ymd(last_year, 1, 1));
        let key = rcgen::KeyPair::generate().expect("random numbers");
        (params.signed_by(&key, &self.issuer).expect("a certificate").pem(), key.serialize_pem())
    }
}

/// A certificate is the other way in: the client's name is in it, and so is a role.
#[test]
fn certificates_let_in_as_tokens_do() {
    let (place, _) = certified();
    let folder = Folder(place.path());
    let (ours, theirs) = (Authority::new(), Authority::new());
    std::fs::write(folder.file(CLIENTS), &ours.pem).expect("a file");
    let server = std::fs::read(folder.file(AUTHORITY)).expect("written");
    let identity = folder.identity().expect("it can be used");
    let house = House { register: Some(tokens().register), identity, revocations: None };
    let (plan, mailbox) = (ring_plan(&Coupling::Parallel), Mailbox::new());
    let lobby = Lobby::open_house(loopback(), &plan, mailbox.clone(), house).expect("a free port");
    let with = |(certificate, key): (String, String)| Entrance {
        address: lobby.address(),
        token: None,
        trust: Some(Trust::showing(&server, certificate.as_bytes(), key.as_bytes()).expect("they go together")),
    };
    for (certificate, why) in [
        (theirs.gives("anna", Some("operator"), 2090), "the other side does not trust this certificate"),
        (ours.gives("anna", Some("operator"), 2021), "this certificate has expired"),
        (ours.gives("anna", Some("king"), 2090), "the organisational unit (OU) of its subject must be"),
        (ours.gives("a b", None, 2090), "the common name (CN) of its subject is not a client's name"),
        (ours.gives("wall", Some("viewer"), 2090), "certificate `wall` lets its holder look, and change nothing"),
        (ours.gives("alpha", None, 2090), "certificate `alpha` is good for `client:alpha`, not to be an operator"),
    ] {
        let said = asked(with(certificate));
        assert!(said.contains(why), "{why:?} is not in {said:?}");
    }
    let mut clients = boxed(ring());
    let mut second = clients.remove(1);
    let other = take_part(second.as_mut(), with(ours.gives("alpha", None, 2090))).expect_err("another's").to_string();
    assert!(other.contains("certificate `alpha` is good for `client:alpha`, not for client `beta`"), "{other}");
    assert!(mailbox.is_empty(), "nothing of it has reached the session");

    clients.insert(1, second);
    let threads: Vec<_> = clients
        .into_iter()
        .zip(RING)
        .map(|(mut client, (name, _))| {
            let entrance = with(ours.gives(name, None, 2090));
            std::thread::spawn(move || take_part(client.as_mut(), entrance))
        })
        .collect();
    let mut formation = Formation::new(plan);
    formation.set_mailbox(mailbox.clone());
    formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |_| true).expect("all come");
    let outcome = run(formation.start().expect("all have joined"), at_ms(200));
    for thread in threads {
        assert_eq!(thread.join().expect("no panic").expect("it has taken part"), outcome.end);
    }
    assert_eq!(outcome, undisturbed());
}

/// A session that certificates let in, whose list of revoked ones this is.
fn revocable(list: &std::sync::Arc<std::sync::Mutex<Revoked>>) -> RevocationList {
    let list = std::sync::Arc::clone(list);
    RevocationList::new(move || Ok(list.lock().expect("no panic").clone()))
}

fn fingerprint(pem: &str) -> Fingerprint {
    Fingerprint::of(&first_certificate(pem.as_bytes()).expect("a certificate"))
}

/// A revoked certificate is refused at its next handshake, an operator that is in is sent away, and the session of a client that
/// takes part ends.
#[test]
fn a_revoked_certificate_is_good_for_nothing_more() {
    let (place, _) = certified();
    let (folder, ours) = (Folder(place.path()), Authority::new());
    std::fs::write(folder.file(CLIENTS), &ours.pem).expect("a file");
    let server = std::fs::read(folder.file(AUTHORITY)).expect("written");
    let list = std::sync::Arc::new(std::sync::Mutex::new(Revoked::new()));
    let identity = folder.identity().expect("it can be used");
    let house = House { register: None, identity, revocations: Some(revocable(&list)) };
    let (plan, mailbox) = (ring_plan(&Coupling::Parallel), Mailbox::new());
    let lobby = Lobby::open_house(loopback(), &plan, mailbox.clone(), house).expect("a free port");
    let with = |(certificate, key): &(String, String)| Entrance {
        address: lobby.address(),
        token: None,
        trust: Some(Trust::showing(&server, certificate.as_bytes(), key.as_bytes()).expect("they go together")),
    };
    let (anna, wall) = (ours.gives("anna", Some("operator"), 2090), ours.gives("wall", Some("viewer"), 2090));
    let revoke = |certificate: &str| {
        list.lock().expect("no panic").insert(fingerprint(certificate));
    };

    let members: Vec<_> = RING.iter().map(|(name, _)| ours.gives(name, None, 2090)).collect();
    let threads: Vec<_> = boxed(ring())
        .into_iter()
        .zip(&members)
        .map(|(mut client, member)| {
            let entrance = with(member);
            std::thread::spawn(move || take_part(client.as_mut(), entrance))
        })
        .collect();
    let mut formation = Formation::new(plan);
    formation.set_mailbox(mailbox.clone());
    formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |_| true).expect("all come");
    let mut lockstep = formation.start().expect("all have joined");
    lockstep.set_mailbox(mailbox);

    let mut inside = OperatorConnection::open(with(&wall)).expect("not revoked yet");
    revoke(&anna.0);
    let refused = asked(with(&anna));
    assert!(refused.contains("this certificate has been revoked"), "{refused}");
    revoke(&wall.0);
    let sent_away = inside.ask(Wish::Look(Vec::new()), PATIENCE).expect_err("it is in no more").to_string();
    assert!(sent_away.contains("this certificate has been revoked"), "{sent_away}");

    revoke(&members[0].0);
    let outcome = lockstep.run().expect("nothing is recorded");
    assert!(outcome.end.to_string().contains(&format!("client `{}` failed", RING[0].0)), "{:?}", outcome.end);
    for thread in threads {
        drop(thread.join().expect("no panic"));
    }
}
