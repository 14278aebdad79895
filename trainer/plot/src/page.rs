//! Self-contained pages: text, tables and pictures in one HTML file, without a script, font or style of another file.

use std::fmt::Display;

/// Style sheet of all pages.
pub const STYLE: &str = "body{font:15px/1.45 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;color:#1b1b1b}\
h1{font-size:1.5rem;overflow-wrap:anywhere}h2{font-size:1.15rem;margin-top:2.5rem}\
div.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.85rem;white-space:nowrap}\
th,td{padding:.25rem .6rem;text-align:right;border-bottom:1px solid #ddd}th{border-bottom:2px solid #888;vertical-align:bottom}\
td.text,th.text{text-align:left}tr.other td{color:#666}td b{color:#00527a}small{color:#666;display:block}\
td.worse b{color:#a33c00}code{font-size:.8rem;background:#f3f3f3;padding:.05rem .3rem}\
details{margin:.4rem 0}summary{cursor:pointer;color:#00527a}svg{max-width:100%;height:auto}ul{padding-left:1.2rem}ul.notes{font-size:.8rem;color:#444}";

/// Style of a sentence that nobody may overlook.
const LOUD: &str = "background:#a33c00;color:#fff;padding:.7rem 1rem;font-weight:bold";

/// A page with this title; `body` is HTML.
pub fn page(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{body}</body>\n</html>\n",
        title = escaped(title),
    )
}

/// Escapes text for HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A section of HTML parts; empty if all parts are empty.
pub fn section(title: &str, parts: &[String]) -> String {
    let parts = parts.concat();
    if parts.is_empty() { parts } else { format!("<h2>{}</h2>\n{parts}", escaped(title)) }
}

/// A paragraph of plain text.
pub fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escaped(text))
}

/// A list of plain texts; empty if there are none.
pub fn list(items: &[String]) -> String {
    let items: String = items.iter().map(|item| format!("<li>{}</li>\n", escaped(item))).collect();
    if items.is_empty() { items } else { format!("<ul>\n{items}</ul>\n") }
}

/// A table of HTML cells; `text` lists the columns that hold text.
pub fn table(head: &[&str], text: &[usize], rows: &[Vec<String>]) -> String {
    let class = |k: usize| if text.contains(&k) { " class=\"text\"" } else { "" };
    let head: String =
        head.iter().enumerate().map(|(k, name)| format!("<th{}>{}</th>", class(k), escaped(name))).collect();
    let cell = |(k, cell): (usize, &String)| format!("<td{}>{cell}</td>", class(k));
    let row =
        |row: &Vec<String>| format!("<tr>{}</tr>\n", row.iter().enumerate().map(cell).collect::<String>());
    let rows: String = rows.iter().map(row).collect();
    format!("<div class=\"wide\"><table>\n<tr>{head}</tr>\n{rows}</table></div>\n")
}

/// A table of facts: names and plain texts, which wrap.
pub fn facts(facts: &[(&str, String)]) -> String {
    let row = |(name, text): &(&str, String)| vec![escaped(name), escaped(text)];
    let rows: Vec<_> = facts.iter().map(row).collect();
    table(&["", ""], &[0, 1], &rows).replacen("<table>", "<table style=\"white-space:normal\">", 1)
}

/// A paragraph of plain text that nobody may overlook.
pub fn loud(text: &str) -> String {
    format!("<p style=\"{LOUD}\">{}</p>\n", escaped(text))
}

/// A part that is folded until the reader opens it.
pub fn folded(summary: &str, body: &str) -> String {
    format!("<details><summary>{}</summary>\n{body}</details>\n", escaped(summary))
}

/// A picture that scrolls on a narrow screen rather than shrinking until it cannot be read.
pub fn picture(svg: &str) -> String {
    let start = svg.find("<svg").unwrap_or(0);
    let svg = svg[start..].replacen("<svg", "<svg style=\"min-width:34rem\"", 1);
    format!("<div class=\"wide\">{svg}</div>\n")
}

/// Formats a number with three significant digits.
pub fn number(x: f64) -> String {
    let size = x.abs();
    if x.is_nan() {
        "–".to_owned()
    } else if x.is_infinite() {
        "broke off".to_owned()
    } else if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e4).contains(&size) {
        let digits = (2.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{x:.digits$}")
    } else {
        format!("{x:.2e}")
    }
}

/// Formats a number and its standard error, both to two significant digits of the error.
pub fn with_error(x: f64, error: f64) -> String {
    if !(error > 0.0 && error.is_finite()) {
        return format!("{} ± {}", number(x), number(error));
    }
    let digits = (1.0 - error.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{x:.digits$} ± {error:.digits$}")
}

/// A table cell: a value, with smaller text below it.
pub fn cell(of: impl Display, below: &str) -> String {
    let below = if below.is_empty() { String::new() } else { format!("<small>{}</small>", escaped(below)) };
    format!("<b>{of}</b>{below}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let text = [0.0, 0.012_345, -1.5, 123.45, 2e-5, 31415.9, f64::INFINITY].map(number);
        assert_eq!(text, ["0", "0.0123", "-1.50", "123", "2.00e-5", "3.14e4", "broke off"]);
    }

    #[test]
    fn errors_have_two_digits() {
        assert_eq!(with_error(2.35564, 0.05362), "2.356 ± 0.054");
        assert_eq!(with_error(-123.4, 17.2), "-123 ± 17");
        assert_eq!(with_error(1.5, 0.0), "1.50 ± 0");
    }

    #[test]
    fn loud_text_and_facts_are_escaped() {
        assert!(loud("a < b").contains("font-weight:bold\">a &lt; b</p>"));
        let facts = facts(&[("log", "x & y".to_owned())]);
        assert!(facts.contains("white-space:normal") && facts.contains(">x &amp; y</td>"), "{facts}");
    }

    #[test]
    fn text_is_escaped() {
        let page = page("a <b>", &paragraph("c & d"));
        assert!(page.contains("<h1>a &lt;b&gt;</h1>") && page.contains("<p>c &amp; d</p>"));
        assert!(table(&["<"], &[0], &[vec!["1".into()]]).contains("<th class=\"text\">&lt;</th>"));
    }
}
