//! Statements with their verdicts.

use crate::csv::number;
use crate::markup::{Escaped, put};
use crate::page::{Claim, Verdict};

pub(crate) fn put_claims(out: &mut String, claims: &[Claim]) {
    if claims.is_empty() {
        return;
    }
    put_tally(out, claims);
    out.push_str("<ul class=\"claims\">\n");
    for claim in claims {
        let (class, symbol, word, why) = match &claim.verdict {
            Verdict::Holds => ("holds", "✓", "holds", None),
            Verdict::Fails(why) => ("fails", "✗", "fails", Some(why)),
            Verdict::Open(why) => ("open", "?", "open", Some(why)),
        };
        put!(
            out,
            "<li class=\"{class}\" id=\"claim:{0}\" data-claim=\"{0}\" data-value=\"{1}\">\n\
             <p class=\"verdict\"><span aria-hidden=\"true\">{symbol}</span> {word}</p>\n\
             <div>\n<p class=\"statement\">{2}</p>\n<p class=\"measured\">{3}</p>\n",
            claim.id,
            number(claim.value),
            Escaped(&claim.statement),
            Escaped(&claim.measured)
        );
        if let Some(why) = why.filter(|why| !why.is_empty()) {
            put!(out, "<p class=\"why\">Why: {}</p>\n", Escaped(why));
        }
        out.push_str("</div>\n</li>\n");
    }
    out.push_str("</ul>\n");
}

/// How many of several statements hold.
fn put_tally(out: &mut String, claims: &[Claim]) {
    if claims.len() < 2 {
        return;
    }
    let count = |which: fn(&Verdict) -> bool| claims.iter().filter(|claim| which(&claim.verdict)).count();
    let counts = [
        (count(|verdict| matches!(verdict, Verdict::Holds)), "holds", "hold"),
        (count(|verdict| matches!(verdict, Verdict::Fails(_))), "fails", "fail"),
        (count(|verdict| matches!(verdict, Verdict::Open(_))), "is open", "are open"),
    ];
    let told = counts.iter().filter(|(count, ..)| *count > 0);
    let words: Vec<String> =
        told.map(|(count, one, more)| format!("{count} {}", if *count == 1 { one } else { more })).collect();
    put!(out, "<p class=\"tally\">Of {} statements {}.</p>\n", claims.len(), words.join(", "));
}
