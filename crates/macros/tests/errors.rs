//! What is wrong with scripts, and where.

use std::collections::BTreeMap;

use pathwright_macros::{Condition, ErrorKind, State, Value, expand, holds};

fn names() -> BTreeMap<String, Value> {
    BTreeMap::from([
        ("temperature".into(), vec![215, 230].into()),
        ("layer_z".into(), Value::Real(0.3)),
        ("note".into(), "text".into()),
        ("maybe".into(), Value::Nil),
        ("nothing".into(), Value::List(Vec::new())),
    ])
}

fn error(script: &str) -> pathwright_macros::Error {
    match expand(script, &names(), &mut State::default()) {
        Ok(text) => panic!("{:.200}: {:.200}", script, text),
        Err(error) => error,
    }
}

#[test]
fn every_mistake_has_its_kind_and_place() {
    use ErrorKind::*;
    let cases = [
        ("a\nb {temprature[0]}", UnknownName, 2, 4),
        ("[layer_q]", UnknownName, 1, 2),
        ("[temperature_x]", UnknownName, 1, 2),
        ("[temperature_[x]]", UnknownName, 1, 15),
        ("é {1 +}", Syntax, 1, 7),
        ("{1", Syntax, 1, 1),
        ("{}", Syntax, 1, 2),
        ("{1 2}", Syntax, 1, 4),
        ("{(1}", Syntax, 1, 4),
        ("{min(1)}", Syntax, 1, 7),
        ("{min(1, 2, 3)}", Syntax, 1, 10),
        ("{\"a}", Syntax, 1, 2),
        ("{\"a\\q\"}", Syntax, 1, 4),
        ("{note =~ /a}", Syntax, 1, 10),
        ("{note =~ note}", Syntax, 1, 10),
        ("{1 + 3}", Syntax, 1, 4),
        ("[temperature", Syntax, 1, 13),
        ("[1]", Syntax, 1, 2),
        ("a {if true} b", Syntax, 1, 4),
        ("{if true}{else}", Syntax, 1, 2),
        ("{if true}{endif}{endif}", Syntax, 1, 18),
        ("{else}", Syntax, 1, 2),
        ("{if true 1 endif}", Syntax, 1, 10),
        ("{if}", Syntax, 1, 4),
        ("{local min = 1}", Syntax, 1, 8),
        ("{local = 1}", Syntax, 1, 8),
        ("{if layer_z}{endif}", Type, 1, 5),
        ("{1 + true}", Type, 1, 6),
        ("{-note}", Type, 1, 3),
        ("{not 1}", Type, 1, 6),
        ("{true and 1}", Type, 1, 11),
        ("{true < false}", Type, 1, 2),
        ("{true == 1}", Type, 1, 2),
        ("{1 =~ /a/}", Type, 1, 2),
        ("{temperature[1.5]}", Type, 1, 14),
        ("{size(layer_z)}", Type, 1, 7),
        ("{int(note)}", Type, 1, 6),
        ("{digits(1, 2.5)}", Type, 1, 12),
        ("{one_of(1, note)}", Type, 1, 9),
        ("{local a = (1, true)}", Type, 1, 13),
        ("{local a = 1; a = (1, 2)}", Type, 1, 15),
        ("{local a = (1, 2); a = 1}", Type, 1, 20),
        ("{local a = repeat(-1, 2)}", Type, 1, 19),
        ("{1 / 0}", Division, 1, 6),
        ("{1 % (1 - 1)}", Division, 1, 7),
        ("{1. / 0.}", Division, 1, 7),
        ("{9223372036854775807 + 1}", Overflow, 1, 2),
        ("{99999999999999999999}", Overflow, 1, 2),
        ("{1e308 * 10}", Overflow, 1, 2),
        ("{int(1e300)}", Overflow, 1, 2),
        ("{random(2, 1)}", Overflow, 1, 2),
        ("{nothing}", Index, 1, 2),
        ("{temperature[-1]}", Index, 1, 14),
        ("{local a = (1, 2); a[2] = 1}", Index, 1, 20),
        ("{maybe + 1}", Nil, 1, 2),
        ("[maybe]", Nil, 1, 2),
        ("{layer_z = 1}", Assignment, 1, 2),
        ("{local layer_z = 1}", Assignment, 1, 8),
        ("{local a = 1; global a = 1}", Assignment, 1, 22),
        ("{local a = ()}", Assignment, 1, 8),
        ("{a = 1}", UnknownName, 1, 2),
        ("{note =~ /(/}", Pattern, 1, 10),
        ("{note =~ /a)|(b/}", Pattern, 1, 10),
        ("{note =~ /(a{1000}){1000}/}", Pattern, 1, 10),
        ("{interpolate_table(5, (0, 0), (1, 1))}", Table, 1, 20),
        ("{interpolate_table(1, (2, 0), (1, 1))}", Table, 1, 32),
        ("{interpolate_table(1, )}", Table, 1, 20),
    ];
    for (script, kind, line, column) in cases {
        let script = script.replacen("{1 + 3}", "{1 \u{ff0b} 3}", 1);
        let found = error(&script);
        assert_eq!((found.kind, found.line, found.column), (kind, line, column), "{script}: {found}");
    }
}

#[test]
fn an_unknown_name_comes_with_the_nearest_known_one() {
    let near = |script| error(script).near;
    assert_eq!(near("{temprature[0]}").as_deref(), Some("temperature"));
    assert_eq!(near("{rond(1.5)}").as_deref(), Some("round"));
    assert_eq!(near("{if true}{elseif true}{endif}").as_deref(), Some("elsif"));
    assert_eq!(near("{local width = 1; widht}").as_deref(), Some("width"));
    assert_eq!(near("{completely_different}"), None);
}

#[test]
fn conditions_have_places_as_well() {
    let error = holds("layer_z < 1 and\nlayr_z > 0", &names()).unwrap_err();
    assert_eq!((error.line, error.column, error.kind), (2, 1, ErrorKind::UnknownName));
    assert_eq!(holds("1 + 1", &names()).unwrap_err().kind, ErrorKind::Type);
    assert_eq!(Condition::parse("1 == 1 }").unwrap_err().column, 8);
}

#[test]
fn no_script_takes_memory_or_time_without_end() {
    let limit = |script: &str| assert_eq!(error(script).kind, ErrorKind::Limit);
    limit(&format!("{{{}1{}}}", "(".repeat(100_000), ")".repeat(100_000)));
    limit(&format!("{{{}1}}", "-".repeat(100_000)));
    limit(&"{if true}".repeat(10_000));
    limit(&format!("{{{}", "temperature[".repeat(10_000)));
    limit(&format!("{{{}", "min(".repeat(10_000)));
    limit(&format!("{{local a = \"0123456789\"{}}}", "; a = a + a".repeat(40)));
    limit(&format!("{{local a = \"0123456789\"{}; a; a; a; a; a; a; a}}", "; a = a + a".repeat(18)));
    limit("{local a = repeat(1000000000, 1)}".replace("1000000000", "60000000").as_str());
    limit(&"x".repeat((1 << 20) + 1));
    limit(&format!("{{{}}}", "note =~ /.*x.*/;".repeat(2000)));
    let mut state = State::default();
    let grows = format!("{{global a = \"0123456789\"{}}}", "; a = a + a".repeat(20));
    let grown: Vec<_> = (0..5)
        .map(|n| {
            expand(&grows.replace('a', &format!("a{n}")).replace("globa0l", "global"), &names(), &mut state)
        })
        .collect();
    assert!(grown.iter().any(Result::is_err));
}

#[test]
fn long_chains_are_no_depth() {
    let script = format!("{{1{}}}", " + 1".repeat(100_000));
    assert_eq!(expand(&script, &names(), &mut State::default()).unwrap(), "100001");
    let script = format!("{{\"\"{}}}", " + \"x\"".repeat(100_000));
    assert_eq!(expand(&script, &names(), &mut State::default()).unwrap().len(), 100_000);
    let script = format!("{{{}5}}", "false ? 1 : ".repeat(10_000));
    assert_eq!(expand(&script, &names(), &mut State::default()).unwrap(), "5");
    let script = format!("{{if false}}{}{{else}}x{{endif}}", "{elsif false}".repeat(10_000));
    assert_eq!(expand(&script, &names(), &mut State::default()).unwrap(), "x");
}
