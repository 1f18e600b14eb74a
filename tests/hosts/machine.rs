//! What holds for every host, shown with a stand-in.

use crate::duet::desk;
use crate::stand_in::duet::Duet;

pub fn what_is_not_for_the_printer_is_not_sent() {
    let duet = Duet::board();
    let desk = desk(&duet);
    let klipper = desk.sliced("klipper.gcode", &["--set", "printer.flavor=klipper", "--labels"]);
    let (code, said) = desk.send(&klipper, &["--start"]);
    assert!(code == 7 && said.contains("which only Klipper knows"), "{code}: {said}");
    let binary = desk.sliced("part.bgcode", &[]);
    let (code, said) = desk.send(&binary, &[]);
    assert!(code == 7 && said.contains("binary"), "{code}: {said}");
    // The stand-in's bed is 250 x 250 mm.
    let large = desk.sliced("large.gcode", &["--set", "bed.offset=[300, 0]"]);
    let (code, said) = desk.send(&large, &[]);
    assert!(code == 7 && said.contains("outside of the printable volume"), "{code}: {said}");
    let text = desk.path("text.gcode");
    std::fs::write(&text, "no moves\n").unwrap();
    assert_eq!(desk.send(&text, &[]).0, 3);
    assert!(duet.machine().files.is_empty());
    let (code, said) = desk.send(&large, &["--no-check"]);
    assert!(code == 0, "{code}: {said}");
}

pub fn a_printer_that_is_not_ready_is_not_started() {
    for status in ["processing", "paused", "busy", "halted", "off"] {
        let duet = Duet::board();
        let desk = desk(&duet);
        let file = desk.sliced("part.gcode", &[]);
        duet.machine().status = status;
        duet.machine().polls = u32::MAX;
        let (code, said) = desk.send(&file, &["--start"]);
        assert!(code == 11 && said.contains(&format!("({status})")), "{status}: {code}: {said}");
        assert!(said.contains("nothing was started") && duet.machine().started.is_empty(), "{said}");
    }
}

pub fn a_full_host_gets_nothing() {
    let duet = Duet::board();
    let desk = desk(&duet);
    duet.machine().free_bytes = 1000;
    let (code, said) = desk.send(&desk.sliced("part.gcode", &[]), &["--start"]);
    assert!(code == 11 && said.contains("MB free"), "{code}: {said}");
    assert!(!duet.server.seen().iter().any(|request| request.method == "POST"), "nothing was sent");
}

pub fn hosts_are_added_listed_and_found_through_a_preset() {
    let duet = Duet::board();
    let desk = desk(&duet);
    let url = format!("http://{}", duet.server.address);
    std::fs::write(desk.path("key"), "open-sesame\n").unwrap();
    let key = desk.path("key").display().to_string();
    let (code, said) =
        desk.run(&["hosts", "add", "shop/duet", "--kind", "duet", "--url", &url, "--key-file", &key]);
    assert_eq!(code, 0, "{said}");
    let (code, said) = desk.run(&["hosts", "list"]);
    assert!(code == 0 && said.contains("shop/duet  duet") && said.contains("key: file"), "{said}");
    assert_eq!(desk.run(&["hosts", "test", "shop/duet"]).0, 0);
    let (code, said) = desk.run(&["hosts", "test", "shop/dued"]);
    assert!(code == 4 && said.contains("did you mean `shop/duet`"), "{code}: {said}");
    let preset = format!(
        "[printer:Mine]\nprinter_technology = FFF\nbed_shape = 0x0,250x0,250x250,0x250\nnozzle_diameter = 0.4\n\
         host_type = duet\nprint_host = {url}\nprinthost_apikey = open-sesame\n\
         [print:P]\nlayer_height = 0.2\n[filament:F]\nfilament_type = PLA\n"
    );
    let presets = desk.path("presets.ini");
    std::fs::write(&presets, preset).unwrap();
    let presets = presets.display().to_string();
    let file = desk.sliced("part.gcode", &[]).display().to_string();
    let (code, said) =
        desk.run(&["send", &file, "--to", "preset", "--printer", "Mine", "--presets", &presets]);
    assert!(code == 0 && duet.machine().files.contains_key("part.gcode"), "{code}: {said}");
    let (code, said) = desk.run(&["hosts", "add", "mine", "--printer", "Mine", "--presets", &presets]);
    assert!(code == 0 && !said.contains("open-sesame"), "{code}: {said}");
    assert!(
        std::fs::read_to_string(desk.path("hosts.toml")).unwrap().contains("[\"mine\"]\nkind = \"duet\"")
    );
}

pub fn physical_printers_of_prusaslicer_are_taken_over() {
    let duet = Duet::board();
    let desk = desk(&duet);
    let presets = desk.path("presets");
    let folder = presets.join("physical_printer");
    std::fs::create_dir_all(&folder).unwrap();
    let url = format!("http://{}", duet.server.address);
    let of = |kind: &str, more: &str| {
        format!(
            "host_type = {kind}\npreset_names = \"Mine\"\nprint_host = {url}\nprinter_technology = FFF\n{more}"
        )
    };
    let duets = of(
        "duet",
        "printhost_apikey = \nprinthost_authorization_type = user\nprinthost_password = open-sesame\n",
    );
    std::fs::write(folder.join("The Duet.ini"), duets).unwrap();
    let link = of(
        "prusalink",
        "printhost_authorization_type = user\nprinthost_user = stored\nprinthost_password = stored\n",
    );
    std::fs::write(folder.join("MK4.ini"), link).unwrap();
    let prusa = of(
        "prusalink",
        "printhost_apikey = open-sesame\nprinthost_cafile = /etc/ca.pem\nprinthost_port = 1\n",
    );
    std::fs::write(desk.path("other.ini"), prusa).unwrap();
    let add = |name: &str, printer: &str, more: &[&str]| {
        let presets = presets.display().to_string();
        let args = ["hosts", "add", name, "--physical-printer", printer, "--presets", &presets];
        let told = desk.run(&[&args[..], more].concat());
        assert!(!told.1.contains("open-sesame"), "{}", told.1);
        told
    };
    assert_eq!(add("duet", "the duet", &[]).0, 0);
    let (code, said) = desk.run(&["hosts", "test", "duet"]);
    assert!(code == 0 && said.contains("duet: ready"), "{code}: {said}");
    let (code, said) = add("mk4", "MK4", &[]);
    assert!(code == 4 && said.contains("in the system's store"), "{code}: {said}");
    assert_eq!(add("mk4", "MK4", &["--user", "maker", "--key-env", "MK4_KEY"]).0, 0);
    assert_eq!(add("other", &desk.path("other.ini").display().to_string(), &[]).0, 0);
    let (code, said) = add("none", "The Duets", &[]);
    assert!(code == 4 && said.contains("did you mean `The Duet`"), "{code}: {said}");
    let hosts = std::fs::read_to_string(desk.path("hosts.toml")).unwrap();
    for wanted in [
        "[\"duet\"]\nkind = \"duet\"",
        "[\"mk4\"]\nkind = \"prusalink\"",
        "key_env = \"MK4_KEY\"\nuser = \"maker\"\nprinter = \"Mine\"",
        "key = \"open-sesame\"\nca = \"/etc/ca.pem\"\nprinter = \"Mine\"",
    ] {
        assert!(hosts.contains(wanted), "{wanted} is not in\n{hosts}");
    }
}

pub fn keys_are_in_no_output_and_no_argument() {
    let duet = Duet::board();
    let desk = desk(&duet);
    let file = desk.sliced("part.gcode", &[]);
    let runs = [
        desk.run(&["hosts", "list"]),
        desk.run(&["hosts", "list", "--json"]),
        desk.run(&["hosts", "test", "--json"]),
        desk.send(&file, &["--start", "--wait", "--json"]),
        desk.run(&["hosts", "add", "--help"]),
    ];
    for (code, said) in &runs {
        assert!(*code == 0 && !said.contains("open-sesame"), "{code}: {said}");
    }
    assert!(runs[3].1.contains("\"verified\":true") && runs[3].1.contains("\"ended\":true"), "{}", runs[3].1);
    let (_, help) = &runs[4];
    assert!(!help.contains("--key <"), "a key would be seen in the list of processes");
}

pub fn an_interrupt_leaves_the_print_alone() {
    let duet = Duet::board();
    let desk = desk(&duet);
    let file = desk.sliced("part.gcode", &[]);
    duet.machine().lasts = u32::MAX;
    let mut sending = desk.begin(&file, &["--start", "--wait"]);
    crate::program::wait_until_started(&mut sending);
    std::process::Command::new("kill").args(["-INT", &sending.id().to_string()]).status().unwrap();
    let (code, said) = crate::program::said(&sending.wait_with_output().unwrap());
    assert!(code == 130 && said.contains("part.gcode goes on printing on it"), "{code}: {said}");
    assert_eq!(duet.machine().status, "processing");
    let asked = duet.server.seen();
    assert!(
        asked.iter().all(|request| !request.target.contains("M25") && !request.target.contains("M0")),
        "no stop"
    );
}

pub fn slicing_and_sending_is_one_command() {
    let duet = Duet::board();
    let desk = desk(&duet);
    desk.sliced("other.gcode", &["--send", "it", "--start"]);
    let machine = duet.machine();
    assert_eq!(machine.started, ["other.gcode"]);
    assert_eq!(machine.files["other.gcode"], std::fs::read(desk.path("other.gcode")).unwrap());
}
