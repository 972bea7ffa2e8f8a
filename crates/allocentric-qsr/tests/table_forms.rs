//! The forms a composition table takes.

use allocentric_qsr::{Case, CompositionTable, DepthReference, Mode};

fn table(case: Case) -> CompositionTable {
    CompositionTable::new(&DepthReference::drs1(), case, Mode::Published)
}

#[test]
fn as_json_rows_and_columns_keep_the_order_of_the_classes() {
    let json = serde_json::to_string(&table(Case::One)).unwrap();
    let expected = concat!(
        r#"{"system":"drs1","case":1,"mode":"published","labels":["c","n","f"],"cells":{"#,
        r#""c":{"c":["c","n","f"],"n":["c","n","f"],"f":["f"]},"#,
        r#""n":{"c":["c","n","f"],"n":["c","n","f"],"f":["f"]},"#,
        r#""f":{"c":["f"],"n":["f"],"f":["c","n","f"]}}}"#,
    );
    assert_eq!(json, expected);
}

#[test]
fn as_text_the_columns_are_aligned() {
    let expected = "\
drs1, CASE 3, published
Dab/Dbc  c    n    f
c        {c}  {n}  {f}
n        {n}  {c}  {f}
f        {f}  {f}  {f}
";
    assert_eq!(table(Case::Three).to_string(), expected);
}

#[test]
fn as_markdown_it_has_a_rule_under_the_header() {
    let expected = "\
| Dab/Dbc | c | n | f |
|---|---|---|---|
| c | {c} | {n} | {f} |
| n | {n} | {c} | {f} |
| f | {f} | {f} | {f} |
";
    assert_eq!(table(Case::Two).to_markdown(), expected);
}
