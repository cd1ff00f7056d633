//! `isolux paper`: the paper's experiments, every figure, every number.

use isolux_report::page::{Block, Verdict};

use crate::failure::{Failure, Outcome};
use crate::options::PaperArgs;
use crate::terminal;

pub(crate) fn run(args: &PaperArgs) -> Outcome {
    let progress = terminal::spinner();
    let page = isolux_experiments::paper::page(args.seed, &mut |step| progress.set_message(step.to_owned()));
    progress.finish_and_clear();
    let page = page?;
    let written = isolux_report::write_report(&page, &args.output, "index.html").map_err(Failure::data)?;
    let blocks = page.sections.iter().flat_map(|section| &section.blocks);
    let claims =
        blocks.filter_map(|block| if let Block::Claims(claims) = block { Some(claims) } else { None });
    for claim in claims.flatten() {
        let (word, why) = match &claim.verdict {
            Verdict::Holds => ("holds", String::new()),
            Verdict::Fails(why) => ("fails", format!(" ({why})")),
            Verdict::Open(why) => ("open ", format!(" ({why})")),
        };
        terminal::print(format!("{word}  {}\n       {}{why}", claim.statement, claim.measured))?;
    }
    terminal::print(format!("written: {}", written.display()))
}
