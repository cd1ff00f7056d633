//! `isolux figures`: what isolux reaches, measured here and now.

use isolux_experiments::unseen::figure::Figure;
use isolux_experiments::unseen::{figures, real_cameras};

use crate::failure::Outcome;
use crate::options::FiguresArgs;
use crate::terminal::{self, Terminal};

pub(crate) fn run(args: &FiguresArgs) -> Outcome {
    if let Some(folder) = &args.recordings {
        real_cameras::expect_recordings(folder)?;
    }
    let progress = terminal::spinner();
    let mut tell = |step: &str| progress.set_message(step.to_owned());
    let mut found = figures::simulated(&mut tell)?;
    if let Some(folder) = &args.recordings {
        found.extend(real_cameras::figures(folder, &Terminal::default(), &mut tell)?);
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
