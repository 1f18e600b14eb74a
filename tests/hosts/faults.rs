//! A table of faults: each ends with a clear error or with success after another try, and never with half a file started.

use std::net::{SocketAddr, TcpListener};
use std::time::Duration;

use crate::program::Desk;
use crate::proxy::{Fault, Proxy, Rule};
use crate::stand_in::duet::Duet;
use crate::stand_in::http::{Answer, Server};
use crate::tls::Encrypted;

const ALWAYS: u32 = u32::MAX;
const LATE: Fault = Fault::Delay(Duration::from_millis(500));

/// What a fault ends with.
#[derive(Clone, Copy)]
pub enum End {
    /// The print has started, once.
    Printed,
    /// Nothing was started; exit code, and words of the message.
    Failed(i32, &'static str),
    /// The start was lost, and not asked again.
    Unknown,
}
use End::{Failed, Printed, Unknown};

/// Requests by which faults are injected.
pub struct Paths {
    pub state: &'static str,
    pub upload: &'static str,
    pub start: &'static str,
}

const BOARD: Paths =
    Paths { state: "GET /rr_model?key=state", upload: "POST /rr_upload", start: "GET /rr_gcode" };

/// Name, requests, how many of them, fault, end.
pub fn rows(paths: &Paths) -> Vec<(&'static str, &'static str, u32, Fault, End)> {
    let Paths { state, upload, start } = *paths;
    vec![
        ("the_upload_is_cut_once", upload, 1, Fault::Cut(1500), Printed),
        ("every_upload_is_cut", upload, ALWAYS, Fault::Cut(1500), Failed(10, "upload: the connection broke")),
        ("the_upload_is_cut_behind_its_head", upload, 1, Fault::Cut(400), Printed),
        ("the_upload_is_reset_once", upload, 1, Fault::Reset, Printed),
        ("every_upload_is_reset", upload, ALWAYS, Fault::Reset, Failed(10, "upload")),
        ("the_upload_is_late", upload, 1, LATE, Printed),
        ("a_byte_is_another_once", upload, 1, Fault::Flip, Printed),
        ("a_byte_is_always_another", upload, ALWAYS, Fault::Flip, Failed(10, "upload: it answers")),
        ("the_answer_to_the_upload_is_lost", upload, 1, Fault::Truncate(0), Printed),
        ("the_answer_to_the_upload_is_cut_off", upload, 1, Fault::Truncate(150), Printed),
        ("the_upload_answers_500_once", upload, 1, Fault::Status(500), Printed),
        (
            "the_upload_always_answers_500",
            upload,
            ALWAYS,
            Fault::Status(500),
            Failed(10, "upload: it answers 500: injected 500"),
        ),
        ("the_upload_answers_503_once", upload, 1, Fault::Status(503), Printed),
        ("the_disk_is_full", upload, 1, Fault::Status(507), Failed(11, "it answers 507")),
        ("the_file_is_too_large", upload, 1, Fault::Status(413), Failed(11, "it answers 413")),
        ("the_state_is_late", state, 1, LATE, Printed),
        ("the_state_is_never_told", state, ALWAYS, Fault::Hang, Failed(10, "state: no answer within 1 s")),
        ("the_state_is_cut_off", state, 1, Fault::Truncate(120), Printed),
        ("something_else_answers_once", state, 1, Fault::Garbage, Printed),
        ("something_else_always_answers", state, ALWAYS, Fault::Garbage, Failed(10, "its answer is no HTTP")),
        ("the_answer_never_ends", state, ALWAYS, Fault::Flood, Failed(10, "far too long")),
        ("the_start_is_late", start, 1, LATE, Printed),
        ("the_answer_to_the_start_is_lost", start, 1, Fault::Truncate(0), Printed),
        ("the_start_is_lost", start, 1, Fault::Reset, Unknown),
        ("the_start_answers_502", start, 1, Fault::Status(502), Unknown),
        ("the_start_is_forbidden", start, 1, Fault::Status(403), Failed(11, "start: it answers 403")),
    ]
}

type Test = Box<dyn FnOnce() + Send>;

/// All faults, before a stand-in of a Duet.
pub fn table() -> Vec<(&'static str, Test)> {
    let injected = rows(&BOARD).into_iter().map(|(name, begins, times, fault, end)| {
        let run = move || injected(Rule { begins, times, fault }, end);
        (name, Box::new(run) as Test)
    });
    let others: [(&str, fn()); 7] = [
        ("nothing_listens", nothing_listens),
        ("a_redirect_gets_no_key", a_redirect_gets_no_key),
        ("the_certificate_has_expired", the_certificate_has_expired),
        ("the_certificate_is_for_another_name", the_certificate_is_for_another_name),
        ("the_authority_is_unknown_until_it_is_given", the_authority_is_unknown_until_it_is_given),
        ("the_port_is_not_encrypted", the_port_is_not_encrypted),
        ("the_name_is_unknown", the_name_is_unknown),
    ];
    injected.chain(others.map(|(name, run)| (name, Box::new(run) as Test))).collect()
}

fn injected(rule: Rule, end: End) {
    let duet = Duet::board();
    let proxy = Proxy::start(duet.server.address, rule.clone());
    let desk = desk(&format!("http://{}", proxy.address));
    let file = desk.sliced("part.gcode", &[]);
    let (code, said) = desk.send(&file, &["--start"]);
    assert!(proxy.hits() > 0, "the fault was met");
    judge(end, code, &said);
    let machine = duet.machine();
    let whole = std::fs::read(&file).unwrap();
    assert!(machine.started.len() <= 1, "{:?}", machine.started);
    assert_eq!(machine.started.is_empty(), !matches!(end, Printed), "{said}");
    assert!(machine.files.get("part.gcode").is_none_or(|stored| *stored == whole), "what is stored is whole");
    if rule.begins == BOARD.start {
        assert_eq!(proxy.hits(), 1, "no start is asked for twice");
    }
}

/// Compares exit code and message with the end that a fault has.
pub fn judge(end: End, code: i32, said: &str) {
    match end {
        Printed => assert_eq!(code, 0, "{said}"),
        Failed(wanted, words) => {
            assert!(code == wanted && said.contains(words) && said.contains("error: it, "), "{code}: {said}");
        }
        Unknown => assert!(code == 10 && said.contains("nothing was asked twice"), "{code}: {said}"),
    }
}

fn desk(url: &str) -> Desk {
    Desk::with("duet", url, "key = \"open-sesame\"")
}

/// Sends to an address at which nothing works; says why.
fn refused(url: &str, args: &[&str]) -> String {
    let desk = desk(url);
    let file = desk.sliced("part.gcode", &[]);
    let (code, said) = desk.send(&file, args);
    assert!(code == 10 && said.contains("error: it, asking who it is: "), "{code}: {said}");
    said
}

fn nothing_listens() {
    let address = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let said = refused(&format!("http://{address}"), &[]);
    assert!(said.contains("nothing listens there") && said.contains("is it on"), "{said}");
}

fn the_name_is_unknown() {
    let said = refused("http://no-such-printer.invalid", &[]);
    assert!(said.contains("its name is not known"), "{said}");
}

fn a_redirect_gets_no_key() {
    let elsewhere = Server::start(|_| Answer::empty(200));
    let to = format!("http://{}/", elsewhere.address);
    let duet = Duet::board();
    let rule = Rule { begins: "GET /", times: ALWAYS, fault: Fault::Redirect(to.clone()) };
    let proxy = Proxy::start(duet.server.address, rule);
    let said = refused(&format!("http://{}", proxy.address), &[]);
    assert!(said.contains(&format!("sends us to {to}")), "{said}");
    assert!(elsewhere.seen().is_empty(), "another host is asked nothing");
}

/// A board behind a certificate, the folder with the authority's, and the address.
fn encrypted(name: &str, until: i32) -> (Duet, Desk, SocketAddr, String) {
    let duet = Duet::board();
    let server = Encrypted::start(duet.server.address, name, until);
    let address = SocketAddr::from(([127, 0, 0, 1], server.port));
    let desk = desk(&format!("https://localhost:{}", server.port));
    let ca = desk.path("ca.pem");
    std::fs::write(&ca, &server.authority).unwrap();
    (duet, desk, address, ca.display().to_string())
}

fn the_certificate_has_expired() {
    let (_duet, desk, _, ca) = encrypted("localhost", 2010);
    let (code, said) = desk.send(&desk.sliced("part.gcode", &[]), &["--ca", &ca]);
    assert!(code == 10 && said.contains("its certificate has expired"), "{code}: {said}");
}

fn the_certificate_is_for_another_name() {
    let (_duet, desk, _, ca) = encrypted("octopi.local", 2090);
    let (code, said) = desk.send(&desk.sliced("part.gcode", &[]), &["--ca", &ca]);
    assert!(code == 10 && said.contains("is for another name"), "{code}: {said}");
}

fn the_authority_is_unknown_until_it_is_given() {
    let (duet, desk, _, ca) = encrypted("localhost", 2090);
    let file = desk.sliced("part.gcode", &[]);
    let (code, said) = desk.send(&file, &[]);
    assert!(code == 10 && said.contains("--ca FILE"), "{code}: {said}");
    assert!(duet.server.seen().is_empty(), "the password goes to nobody that is not trusted");
    let (code, said) = desk.send(&file, &["--ca", &ca]);
    assert!(code == 0 && duet.machine().files.contains_key("part.gcode"), "{code}: {said}");
}

fn the_port_is_not_encrypted() {
    let duet = Duet::board();
    let said = refused(&format!("https://{}", duet.server.address), &[]);
    assert!(said.contains("http://"), "{said}");
}
