//! What scripts write, rule by rule. Each rule was looked up in PrusaSlicer 2.9 unless it says otherwise.

use std::collections::BTreeMap;

use pathwright_macros::{Names, State, Value, expand, holds};

/// Two extruders, the second in use; `position` and `e_restart` may be written.
struct Print(BTreeMap<String, Value>);

impl Print {
    fn new() -> Self {
        let values: [(&str, Value); 16] = [
            ("layer_z", Value::Real(0.3)),
            ("layer_num", Value::Integer(7)),
            ("spiral_vase", Value::Flag(false)),
            ("has_wipe_tower", Value::Flag(true)),
            ("fill_density", Value::Percent(15.0)),
            ("infill_overlap", Value::Percent(25.0)),
            ("printer_notes", "PRINTER_MODEL_MK4\nsecond \"line\"".into()),
            ("print_settings_id", "0.20mm QUALITY @MK4".into()),
            ("temperature", vec![215, 230].into()),
            ("filament_type", vec!["PLA", "PETG"].into()),
            ("is_extruder_used", vec![true, false].into()),
            ("idle_temperature", Value::List(vec![Value::Nil, Value::Integer(100)])),
            ("bed_shape", vec![vec![0.0, 0.0], vec![250.5, 210.0]].into()),
            ("position", vec![1.0, 2.5, 0.3].into()),
            ("e_restart", Value::Real(0.0)),
            ("nothing", Value::List(Vec::new())),
        ];
        Self(values.into_iter().map(|(name, value)| (name.to_owned(), value)).collect())
    }
}

impl Names for Print {
    fn value(&self, name: &str) -> Option<Value> {
        self.0.value(name)
    }

    fn names(&self) -> Vec<String> {
        self.0.names()
    }

    fn extruder(&self) -> usize {
        1
    }

    fn is_writable(&self, name: &str) -> bool {
        matches!(name, "position" | "e_restart")
    }

    fn whole(&self, name: &str) -> Option<f64> {
        (name == "infill_overlap").then_some(0.5)
    }
}

fn text(script: &str) -> String {
    expand(script, &Print::new(), &mut State::default()).unwrap_or_else(|error| panic!("{script}: {error}"))
}

#[track_caller]
fn each(cases: &[(&str, &str)]) {
    for (script, expected) in cases {
        assert_eq!(text(script), *expected, "{script}");
    }
}

#[test]
fn text_stays_as_it_is() {
    each(&[
        ("", ""),
        ("G28 ; home\r\n\tM84\n", "G28 ; home\r\n\tM84\n"),
        ("é } ] \" ' / \\ é", "é } ] \" ' / \\ é"),
        ("a{1}\n  b{2} c\n", "a1\n  b2 c\n"),
    ]);
}

#[test]
fn doubled_braces_are_single_ones() {
    // An addition of this project.
    each(&[
        ("{{", "{"),
        ("M117 {{{layer_num}}} {{a}}", "M117 {7} {a}"),
        ("{{a\nb}}", "{a\nb}}"),
        ("a}}", "a}}"),
        ("{if true}{{x}}{endif}}", "{x}}"),
    ]);
}

#[test]
fn a_backslash_keeps_an_opening_bracket() {
    // As in SuperSlicer.
    each(&[(r"\{layer_num} \[x] \n \\", r"{layer_num} [x] \n \\")]);
}

#[test]
fn names_in_brackets_are_written_as_in_a_configuration() {
    each(&[
        ("[layer_z] [layer_num] [spiral_vase] [has_wipe_tower]", "0.3 7 0 1"),
        ("[fill_density] [infill_overlap]", "15% 25%"),
        ("[printer_notes]", "PRINTER_MODEL_MK4\\nsecond \"line\""),
        ("[temperature] [temperature_0] [temperature_1] [temperature_9]", "230 215 230 215"),
        ("[ temperature_ [layer_num] ][filament_type_[layer_num]]", "215PLA"),
        ("[is_extruder_used_0]", "1"),
        ("[bed_shape_1]", "250.5x210"),
        ("{local a = 3}[a]", "3"),
        // A scalar is its own element, which is an error there.
        ("[layer_z_0]", "0.3"),
    ]);
}

#[test]
fn names_in_braces_are_written_as_values() {
    each(&[
        ("{layer_z} {layer_num} {spiral_vase}", "0.3 7 false"),
        ("{fill_density} {infill_overlap}", "15 0.125"),
        ("{print_settings_id}", "0.20mm QUALITY @MK4"),
        ("{temperature[0]} {temperature[1]} {temperature[2]}", "215 230 215"),
        ("{bed_shape[1]}", "[250.5, 210]"),
        // The extruder in use, as in SuperSlicer; an error in PrusaSlicer.
        ("{temperature} {filament_type}", "230 PETG"),
        ("{layer_z[3]}", "0.3"),
        ("{temperature[layer_num - 6]}", "230"),
    ]);
}

#[test]
fn whole_numbers_stay_whole() {
    each(&[
        ("{7 / 2} {-7 / 2} {7 / 2.} {7. / 2}", "3 -3 3.5 3.5"),
        ("{7 % 3} {-7 % 3} {7.5 % 2} {-7.5 % 2}", "1 -1 1.5 -1.5"),
        ("{2 * 3 / 12} {2. * 3 / 12} {1 + 2 * 3 - 4}", "0 0.5 3"),
        ("{(1 + 2) * (3 - 4)} {- 3 + +4} {--3}", "-3 1 3"),
        ("{1e3} {1.5e-3} {.5} {5.} {2E2}", "1000 0.0015 0.5 5 200"),
        ("{1000000 * 10} {1000000. * 10}", "10000000 1e+07"),
        ("{10.0} {1 / 3.} {2. / 3}", "10 0.333333 0.666667"),
    ]);
}

#[test]
fn a_sum_with_a_text_is_a_text() {
    each(&[
        (r#"{"a" + 1 + 2.50 + true} {1 + 2 + "a"}"#, "a12.5true 3a"),
        (r#"{"quote \" backslash \\ line\nreturn\r"}"#, "quote \" backslash \\ line\nreturn\r"),
        (r#"{"{no} [name] é"}"#, "{no} [name] é"),
    ]);
}

#[test]
fn comparisons_are_true_or_false() {
    each(&[
        ("{1 == 1.} {0.1 + 0.2 == 0.3} {1 != 2} {1 <> 1}", "true true true false"),
        ("{1 < 2} {2 <= 2} {3 > 2.5} {2 >= 3}", "true true true false"),
        (r#"{"a" < "b"} {"10" == 10} {"b" >= "a"}"#, "true true true"),
        ("{true == false} {true != false}", "false true"),
        ("{1 < 2 == true}", "true"),
    ]);
}

#[test]
fn logic_has_words_and_signs() {
    each(&[
        ("{true and false} {true && true} {false or true} {false || false}", "false true true false"),
        ("{not true} {!false} {not false and false} {! (true or false)}", "false true false false"),
        ("{true or true and false}", "true"),
    ]);
}

#[test]
fn a_choice_takes_one_of_two() {
    each(&[
        ("{true ? 1 : 2} {false ? 1 : true ? 2 : 3}", "1 2"),
        ("{1 == 1 ? 2 == 3 ? \"a\" : \"b\" : \"c\"}", "b"),
        // What is not taken need not be known.
        ("{true ? 1 : unknown * 2} {false ? unknown[3] : 1 / 1}", "1 1"),
        ("{(filament_type[0] == \"FLEX\") ? 1 : ((filament_type[1] == \"PETG\") ? 2 : 0)}", "2"),
    ]);
}

#[test]
fn a_regular_expression_matches_the_whole_text() {
    each(&[
        ("{printer_notes =~ /.*MK4.*/} {printer_notes =~ /MK4/}", "true false"),
        ("{printer_notes !~ /.*(MK3|MINI).*/}", "true"),
        (r#"{"a/b" =~ /a\/b/} {"ab" =~ /a|b/} {"(" =~ /\(/}"#, "true false true"),
        ("{\"a\nb\" =~ /a.b/} {\"é\" =~ /é/} {\"AB\" =~ /(?i)a[b-d]/}", "true true true"),
    ]);
}

#[test]
fn functions() {
    each(&[
        ("{min(12, 14)} {max(12, 14.5)} {min(-1.5, 2)}", "12 14.5 -1.5"),
        (
            "{int(13.9)} {int(-13.9)} {round(13.5)} {round(-13.5)} {round(13.4)} {int(5)}",
            "13 -13 14 -14 13 5",
        ),
        ("{ceil(13.1)} {ceil(-13.9)} {floor(13.9)} {floor(-13.1)} {ceil(5)}", "14 -13 13 -14 5"),
        ("{digits(5, 4)}|{digits(5.6, 4)}|{digits(-5, 4)}|{digits(5, 0)}", "   5|   6|  -5|5"),
        ("{zdigits(5, 4)}|{zdigits(-5, 4)}|{zdigits(2.345, 7, 2)}", "0005|-005|0002.35"),
        ("{digits(13.84375892476, 15, 8)}|{digits(1, 5, 1)}", "    13.84375892|  1.0"),
        ("{is_nil(idle_temperature[0])} {is_nil(idle_temperature[1])} {is_nil(layer_z)}", "true false false"),
        ("{is_nil(idle_temperature[0]) ? 150 : idle_temperature[0]}", "150"),
        ("{empty(nothing)} {empty(temperature)} {size(temperature)} {size(nothing)}", "true false 2 0"),
    ]);
}

#[test]
fn one_of_compares_with_texts_and_expressions() {
    each(&[
        (
            r#"{one_of("a", "b", "a")} {one_of("a", "b")} {one_of("a")} {one_of("a",)}"#,
            "true false false false",
        ),
        (
            r#"{one_of("abc", /.*c/)} {one_of("abc", ~".*d", ~"a.*")} {one_of("abc", "b", /c/,)}"#,
            "true true false",
        ),
        (r#"{one_of(filament_type[1], "PET" + "G")}"#, "false"),
    ]);
}

#[test]
fn tables_are_interpolated() {
    each(&[
        ("{interpolate_table(5, (0, 0), (10, 20))} {interpolate_table(10, (0, 0), (10, 20),)}", "10 20"),
        ("{interpolate_table(25, (0, 0), (20, 20), (30, 10))} {interpolate_table(0, (0, 7))}", "15 7"),
        ("{interpolate_table(layer_z, (0,7000), (150,7000), (200,4000), (270,2000))}", "7000"),
        ("{interpolate_table(10.00005, (0, 1), (10, 2))}", "2"),
    ]);
}

#[test]
fn branches_are_text_or_statements() {
    each(&[
        ("{if true}a{endif}{if false}b{endif}", "a"),
        ("{if false}a{elsif true}b{else}c{endif}", "b"),
        ("{if false}a{elsif false}b{else}c{endif}", "c"),
        ("{if layer_num > 5}\nM1\n{endif}\nM2", "\nM1\n\nM2"),
        ("{if true}{if false}a{else}b{endif}{else}{unknown}{endif}", "b"),
        ("{if true then 1 else 2 endif}", "1"),
        ("{if false then 1; elsif true then 2; 3; else 4 endif}", "23"),
        ("{if false then elsif false then else endif}", ""),
        ("{if 1 == 1 then if 2 == 3}unknown{else 5 endif else if unknown then else 6 endif endif}", "5"),
        ("{if true}a{else}b{endif;1;2}", "a12"),
        ("{if true then 1 endif if true then 2 endif 3}", "123"),
    ]);
}

#[test]
fn statements_are_separated_by_semicolons() {
    each(&[("{1;2}", "12"), ("{1;;;2;}", "12"), ("{;1}", "1"), ("{local a = 2; a * 3}", "6")]);
}

#[test]
fn variables_keep_their_type() {
    each(&[
        ("{local a = 33 + 2}{a}", "35"),
        ("{local a = 1; a = 2.9; a}", "2"),
        ("{local a = 1.5; a = 2; a / 4}", "0.5"),
        (r#"{local a = "x"; a = 2.5; a}"#, "2.5"),
        ("{local a = true; a = false; a}", "false"),
        ("{local a = 1; local a = 2; a}", "2"),
        ("{global a = 1; a = a + 1; a}", "2"),
        ("{local a = 1 == 1}{a}", "true"),
        ("{local a = 1}{a == 1}{a != 1}", "truefalse"),
    ]);
}

#[test]
fn vectors_are_made_of_lists_repeats_and_copies() {
    each(&[
        ("{local a = (1, 2 * 3, 4)}{a[1]} {size(a)}", "6 3"),
        ("{local a = (1, 2.5)}{a[0] / 2}", "0.5"),
        (r#"{local a = (1, "b", true)}{a[0] + a[2]}"#, "1true"),
        ("{local a = (1 + 2) * 3}{a}", "9"),
        ("{local a = (3)}{size(a)}", "1"),
        ("{local a = repeat(2 * 3, 4)}{size(a)}{a[5]}", "64"),
        ("{local a = repeat(0, 4)}{empty(a)}", "true"),
        ("{local a = temperature}{a[0] = 1}{a[0]} {a[1]} {temperature[0]}", "1 230 215"),
        ("{local a = (1, 2); a = (); size(a)}", "0"),
        ("{local a = (1, 2); a = (3.9, 4, 5); a[0] + size(a)}", "6"),
        ("{local a = temperature; a = (1); a = temperature; a[1]}", "230"),
        ("{local a = 5; a = (7); a}", "7"),
        ("{if 1 == 0}{local a = (5, 4)}{else}{local b = (1., 2., 3.)}{endif}{size(b)}", "3"),
    ]);
}

#[test]
fn a_script_writes_placeholders_that_it_may_write() {
    let mut state = State::default();
    let script = "{position[2] = position[2] + 1; e_restart = 2}{position[2]} {position[0]}";
    assert_eq!(expand(script, &Print::new(), &mut state).unwrap(), "1.3 1");
    assert_eq!(state.written()["position"], Value::from(vec![1.0, 2.5, 1.3]));
    assert_eq!(state.written()["e_restart"], Value::Real(2.0));
    expand("", &Print::new(), &mut state).unwrap();
    assert!(state.written().is_empty(), "of an earlier script");
}

#[test]
fn locals_end_with_the_script_and_globals_do_not() {
    let (print, mut state) = (Print::new(), State::default());
    expand("{local a = 1; global b = (1, 2)}", &print, &mut state).unwrap();
    assert_eq!(expand("{b[1]}", &print, &mut state).unwrap(), "2");
    assert!(expand("{a}", &print, &mut state).is_err());
}

#[test]
fn random_numbers_depend_on_the_seed_alone() {
    let script = "{random(1, 6)} {random(0.5, 1)} {random(-3, -3)}";
    let roll = |seed| expand(script, &Print::new(), &mut State::new(seed)).unwrap();
    assert_eq!(roll(1), roll(1));
    assert_ne!(roll(1), roll(2));
    let mut state = State::default();
    let faces: std::collections::BTreeSet<String> =
        (0..200).map(|_| expand("{random(1, 6)}", &Print::new(), &mut state).unwrap()).collect();
    assert_eq!(faces.into_iter().collect::<String>(), "123456");
}

#[test]
fn functions_of_superslicer() {
    each(&[
        ("{if exists(chamber) then 1 else 2 endif}{exists(layer_z)}", "2true"),
        ("{if not exists(a) then local a = 5 endif; a; exists(a)}", "5true"),
        ("{if exists(chamber) and chamber then 1 endif}", ""),
        ("{default_int(fans, 3)}{fans + 1}{default_double(layer_z, 9)}{layer_z}", "40.3"),
        (r#"{default_string(a, "x")}{default_bool(b, true)}{a}{b}"#, "xtrue"),
        ("{ignore_legacy(true)}[some][any_[x]]", "[some][any_[x]]"),
    ]);
}

#[test]
fn conditions() {
    let holds = |condition: &str| holds(condition, &Print::new()).unwrap();
    assert!(holds(""));
    assert!(holds(" \n"));
    assert!(holds("printer_notes=~/.*PRINTER_MODEL_MK4.*/ and temperature[0]==215 and layer_num>1"));
    assert!(!holds("printer_notes=~/.*MINI.*/ or layer_num > 7"));
    assert!(holds(r#"! spiral_vase and one_of(filament_type[0], "PLA", "PETG")"#));
}
