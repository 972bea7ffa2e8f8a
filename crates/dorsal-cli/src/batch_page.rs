use crate::batch::PairRecord;

/// The page of a batch: every pair with its figures, and the way to its own page.
pub(crate) fn batch_page(pairs: &[PairRecord]) -> String {
    let number = |number: Option<f64>, digits: usize| {
        number.map_or_else(String::new, |number| format!("{number:.digits$}"))
    };
    let lines: String = pairs
        .iter()
        .map(|pair| {
            let name = escaped(&pair.name);
            let link = if pair.error.is_none() {
                format!("<a href=\"{name}/index.html\">{name}</a>")
            } else {
                name
            };
            format!(
                "<tr><th scope=\"row\">{link}</th><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
                 <td>{}</td></tr>\n",
                pair.state.word(),
                number(pair.density.map(|density| 100.0 * density), 1),
                number(pair.median_px, 2),
                escaped(pair.error.as_deref().unwrap_or_default())
            )
        })
        .collect();
    include_str!("batch_page.html").replacen("LINES", &lines, 1)
}

/// Text as a page holds it.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
