//! `isolux figures`: what isolux reaches, measured here and now.

mod real;

use isolux_experiments::unseen::figure::Figure;
use isolux_experiments::unseen::figures;

use crate::failure::{Failure, Outcome};
use crate::options::FiguresArgs;
use crate::terminal;

pub(crate) fn run(args: &FiguresArgs) -> Outcome {
    if let Some(folder) = &args.recordings {
        real::expect_recordings(folder)?;
    }
    let progress = terminal::spinner();
    let found = figures::simulated(&mut |step| progress.set_message(step.to_owned()));
    let mut found = found.map_err(Failure::data)?;
    if let Some(folder) = &args.recordings {
        found.extend(real::figures(folder, &mut |step| progress.set_message(step.to_owned()))?);
    }
    progress.finish_and_clear();
    if args.json {
        return terminal::print_json(&found.iter().map(json).collect::<Vec<_>>());
    }
    terminal::print(markdown(&found))
}

fn json(figure: &Figure) -> serde_json::Value {
    serde_json::json!({
        "subject": figure.subject,
        "what": figure.what,
        "value": figure.value.is_finite().then_some(figure.value),
        "text": figure.value_text(),
        "aim": figure.aim_text(),
        "met": figure.met(),
    })
}

/// A table as Markdown writes it.
fn markdown(figures: &[Figure]) -> String {
    let mut lines =
        vec!["| step | figure | value | aim | met |".to_owned(), "|---|---|---|---|---|".to_owned()];
    lines.extend(figures.iter().map(|figure| {
        let met = figure.met().map_or("", |met| if met { "yes" } else { "**no**" });
        format!(
            "| {} | {} | {} | {} | {met} |",
            figure.subject,
            figure.what,
            figure.value_text(),
            figure.aim_text()
        )
    }));
    lines.join("\n")
}
