//! The link between a world and a processor in another place: its messages, and the processor's end, [`serve`].
//!
//! `firmware-sim/LINK.md` describes the frames byte by byte. The world asks and the processor answers, one frame each
//! way: first a [`Program`](crate::Program), answered with [`Answer::Ready`] or a [`Refusal`], then tick after tick.
//! Nothing is sent twice: a frame that does not arrive whole ends the run.

mod frame;
mod message;
mod refusal;
mod serve;
mod slot;

pub use frame::{Broken, Frame, MAX_FRAME, Receiver};
pub use message::{
    Answer, Done, LoggedSamples, PART, Request, Samples, VERSION, answer, parse_answer, parse_request,
    request,
};
pub use refusal::{ModelRefusal, PlanFault, ProgramFault, Refusal, SettingsFault};
pub use serve::{PLACES, Port, Workspace, serve, serve_arm};
pub use slot::{Files, Flash};
