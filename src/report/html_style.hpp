#pragma once

namespace deltadyn {

/// The look of a report: dark on white, fonts of the system, fit for paper. It must not contain '<', '&' or '>': the
/// page is XML, too.
inline constexpr const char* kHtmlStyle = R"css(
:root { color-scheme: light; --ink: #1c2430; --soft: #5b6675; --line: #dde2e8; --pale: #f5f7f9;
  --good: #1a7f4b; --good-pale: #edf7f1;
  --caution: #9a6200; --caution-pale: #fdf6e7; --bad: #b3261e; --bad-pale: #fcf0ef; }
* { box-sizing: border-box; }
body { margin: 0; background: #fff; color: var(--ink);
  font: 15px/1.5 system-ui, 'Segoe UI', 'Helvetica Neue', Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif; }
main { max-width: 960px; margin: 0 auto; padding: 28px 24px 40px; }
header { border-bottom: 2px solid var(--ink); margin-bottom: 14px; padding-bottom: 8px; }
h1 { font-size: 25px; line-height: 1.25; margin: 0; letter-spacing: -0.01em; }
h2 { font-size: 18px; margin: 30px 0 8px; padding-bottom: 4px; border-bottom: 1px solid var(--line); }
h3 { font-size: 15px; margin: 18px 0 4px; }
p { margin: 6px 0 10px; max-width: 76ch; }
ul { margin: 4px 0 10px; padding-left: 22px; max-width: 76ch; }
li { margin: 2px 0; }
.subtitle { color: var(--soft); margin: 4px 0 0; }
.note, figcaption, caption, footer { color: var(--soft); font-size: 13px; }
nav { font-size: 13.5px; margin: 0 0 14px; }
nav a { color: #00558c; text-decoration: none; margin-right: 16px; white-space: nowrap; }
nav a:hover { text-decoration: underline; }
.verdict { border: 1px solid; border-left-width: 6px; border-radius: 4px; padding: 10px 16px; margin: 0 0 16px; }
.verdict .headline { font-size: 17px; font-weight: 600; margin: 0; max-width: none; }
.verdict .mark { display: inline-block; width: 22px; height: 22px; margin-right: 10px;
  border-radius: 50%; color: #fff; font-size: 14px; line-height: 22px; text-align: center; font-weight: 700; }
.verdict ul { margin: 6px 0 0; padding-left: 50px; max-width: none; }
.verdict.good { border-color: var(--good); background: var(--good-pale); }
.verdict.caution { border-color: var(--caution); background: var(--caution-pale); }
.verdict.bad { border-color: var(--bad); background: var(--bad-pale); }
.verdict.good .mark { background: var(--good); }
.verdict.caution .mark { background: var(--caution); }
.verdict.bad .mark { background: var(--bad); }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 10px; margin: 0 0 16px; }
.key { border: 1px solid var(--line); border-radius: 4px; padding: 8px 12px; background: var(--pale); }
.key .label { font-size: 12.5px; color: var(--soft); }
.key .value { font-size: 20px; font-weight: 600; line-height: 1.35;
  font-variant-numeric: tabular-nums; white-space: nowrap; }
.key .small { font-size: 12.5px; color: var(--soft); }
.key.good { border-left: 4px solid var(--good); }
.key.caution { border-left: 4px solid var(--caution); }
.key.bad { border-left: 4px solid var(--bad); }
.key.muted .value { color: var(--soft); }
.table { overflow-x: auto; margin: 10px 0 16px; }
table { border-collapse: collapse; font-size: 13.5px; line-height: 1.4; font-variant-numeric: tabular-nums; }
caption { text-align: left; padding: 0 0 5px; }
caption b, figcaption b { color: var(--ink); font-weight: 600; }
th { font-weight: 600; border-bottom: 1.5px solid var(--ink); vertical-align: bottom; }
th, td { padding: 3px 14px 3px 8px; }
td { border-bottom: 1px solid var(--line); white-space: nowrap; }
td.left { white-space: normal; min-width: 6ch; }
.left { text-align: left; }
.center { text-align: center; }
.right { text-align: right; }
tr.good td { background: var(--good-pale); }
tr.caution td { background: var(--caution-pale); }
tr.bad td { background: var(--bad-pale); }
tr.muted td { color: var(--soft); }
tr.strong td { font-weight: 600; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 2px 18px; margin: 8px 0 14px; font-size: 13.5px; }
dt { color: var(--soft); }
dd { margin: 0; overflow-wrap: anywhere; }
figure { margin: 12px 0 18px; }
figure svg { display: block; width: 100%; height: auto; }
figcaption { margin-top: 2px; max-width: 90ch; }
details { border: 1px solid var(--line); border-radius: 4px; padding: 6px 14px; margin: 10px 0 14px; }
summary { cursor: pointer; font-weight: 600; }
details[open] summary { margin-bottom: 6px; }
footer { border-top: 1px solid var(--line); margin-top: 32px; padding-top: 8px; overflow-wrap: anywhere; }
@page { size: A4; margin: 14mm; }
@media print {
  body { font-size: 9.5pt; -webkit-print-color-adjust: exact; print-color-adjust: exact; }
  main { max-width: none; padding: 0; }
  h1 { font-size: 17pt; }
  h2 { font-size: 12.5pt; margin-top: 16pt; }
  .verdict .headline { font-size: 11pt; }
  .figures { grid-template-columns: repeat(auto-fit, minmax(104px, 1fr)); gap: 6px; }
  .key { padding: 5px 8px; }
  .key .value { font-size: 12.5pt; }
  table, dl, .note, figcaption, caption, footer, .key .label, .key .small { font-size: 8.5pt; }
  th, td { padding: 2px 8px 2px 5px; }
  nav { display: none; }
  h2, h3 { break-after: avoid; }
  figure, .verdict, .key, tr { break-inside: avoid; }
  caption, thead { break-after: avoid; }
  thead { display: table-header-group; }
  details::details-content { content-visibility: visible; block-size: auto; }
}
)css";

}  // namespace deltadyn
