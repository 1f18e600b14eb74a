//! Duets, stood in for.

use crate::program::Desk;
use crate::stand_in::duet::{Duet, PASSWORD};

/// A desk that knows it.
pub fn desk(duet: &Duet) -> Desk {
    Desk::with("duet", &format!("http://{}", duet.server.address), &format!("key = \"{PASSWORD}\""))
}

fn takes_and_prints(duet: &Duet) {
    let desk = desk(duet);
    let file = desk.sliced("a part.gcode", &["--set", "printer.flavor=reprapfirmware"]);
    let (code, said) = desk.send(&file, &[]);
    assert_eq!(code, 0, "{said}");
    assert!(duet.machine().started.is_empty(), "nothing starts by itself");
    assert_eq!(duet.machine().files["a_part.gcode"], std::fs::read(&file).unwrap());
    let (code, said) = desk.send(&file, &["--start"]);
    assert!(code == 11 && said.contains("--replace"), "{code}: {said}");
    let (code, said) = desk.send(&file, &["--replace", "--start", "--wait"]);
    assert!(code == 0 && said.contains("it: printed a_part.gcode"), "{code}: {said}");
    assert_eq!(duet.machine().started, ["a_part.gcode"]);
    let (code, said) = desk.run(&["hosts", "test"]);
    assert!(
        code == 0 && said.contains("ready; RepRapFirmware (stand-in) 3.6") && said.contains("250 x 250"),
        "{said}"
    );
}

pub fn a_board_takes_files_and_prints_them() {
    takes_and_prints(&Duet::board());
}

pub fn a_computer_takes_files_and_prints_them() {
    takes_and_prints(&Duet::computer());
}

pub fn a_wrong_password_is_told_and_not_shown() {
    for duet in [Duet::board(), Duet::computer()] {
        let url = format!("http://{}", duet.server.address);
        let desk = Desk::with("duet", &url, "key = \"guessed-wrong\"");
        let (code, said) = desk.run(&["hosts", "test", "it"]);
        assert_eq!(code, 11, "{said}");
        assert!(said.contains("it, asking who it is") && !said.contains("guessed-wrong"), "{said}");
    }
}
