// Studies between the runs of the list: a row each, which opens to the runs of its trials.

import { getJson, isOver, listRuns, listStudies } from "../base/api.js";
import { h, iconButton, link, setText } from "../base/dom.js";
import { age, moment } from "../base/format.js";
import { address } from "../base/router.js";
import { statePill } from "../base/run_words.js";
import { parameterAt } from "../scenario/parameters.js";
import { figureNames, figureUnit } from "../study/figures.js";
import { methodWords, nameOfStudy, parametersWords, spreadOf, trialsWords, valueWords } from "../study/study_words.js";
import { columns } from "./runs_columns.js";

const LIMIT = 50; // studies of a page, and runs that an open study shows

const answers = new Map(); // id of a study that is over -> a promise of what it found, in words

async function findAnswer({ id }) {
  const [{ best }, { base, parameters, objectives, curves }] =
    await Promise.all([getJson(`v1/studies/${id}/best`), getJson(`v1/studies/${id}/document`)]);
  if (!best) return "";
  const words = new Map(parameters.map(({ pointer }) => [pointer, parameterAt(pointer, base.scenario)]));
  const name = figureNames({ objectives, curves })[0];
  return `best: ${parametersWords(best.parameters, words)}, ${valueWords(spreadOf(best.values[name] ?? {}), figureUnit(name))}`;
}

export class StudyRow {
  // onToggle(study).
  constructor(study, onToggle) {
    this.id = study.id;
    this.toggle = iconButton("chevron", "", () => onToggle(this.study), { class: "bare" });
    this.title = link(address("studies", study.id), "");
    this.state = statePill(study);
    this.trials = h("span", { class: "figures" });
    this.age = h("time", { datetime: study.created_at, title: moment(study.created_at) });
    this.answer = h("span", { class: "answer" });
    this.rest = h("td", { role: "cell", class: "rest" }, h("span", {}, methodWords(study)), this.state.pill, this.trials, this.answer);
    const minor = columns.filter(({ kind }) => kind?.includes("minor")).length; // they stand before the age
    this.span = columns.length - minor - 2; // between the name and them
    this.element = h("tr", { role: "row", class: "study" },
      h("td", { role: "cell", class: "pick" }, this.toggle), h("td", { role: "cell", class: "name" }, this.title), this.rest,
      h("td", { role: "cell", class: "minor", colspan: minor }), h("td", { role: "cell", "data-label": "Age" }, this.age), h("td", { role: "cell", class: "actions" }));
  }

  // n: columns of parameters.
  show({ study, isOpen }, n) {
    this.study = study;
    const name = nameOfStudy(study);
    setText(this.title, name);
    this.toggle.setAttribute("aria-expanded", String(isOpen));
    this.toggle.setAttribute("aria-label", `Runs of the study ${name}`);
    this.toggle.title = isOpen ? "Hide the runs" : "Show the runs";
    this.state.show(study);
    setText(this.trials, trialsWords(study));
    setText(this.age, age(study.created_at));
    this.rest.colSpan = this.span + n;
    if (isOver(study) && !this.isAsked) this.showAnswer(study);
  }

  // It follows the list, which does not wait for it.
  async showAnswer(study) {
    this.isAsked = true;
    if (!answers.has(study.id)) answers.set(study.id, findAnswer(study));
    try {
      setText(this.answer, await answers.get(study.id));
    } catch {
      answers.delete(study.id);
      this.isAsked = false; // asked for again when the list is
    }
  }
}

// The row behind what is not shown in full: the runs of an open study, or the studies of a page.
export class MoreRow {
  constructor({ href, text }) {
    this.cell = h("td", { role: "cell" }, link(href, text));
    this.element = h("tr", { role: "row", class: "more" }, this.cell);
  }

  // n: columns of parameters.
  show(n) {
    this.cell.colSpan = columns.length + 2 + n;
  }
}

// The row above the runs of one version of a line.
export class VersionRow {
  // version: { number, runs }, its newest run first.
  constructor({ number, runs }) {
    const [{ id }] = runs;
    this.text = h("span", { class: "figures" });
    this.cell = h("td", { role: "cell" }, h("strong", {}, `Version ${number}`), this.text,
      link(address("new", "", { from: id }), "Change and run", { "aria-label": `Change and run version ${number}` }));
    this.element = h("tr", { role: "row", class: "version" }, this.cell);
  }

  // n: columns of parameters.
  show({ runs }, n) {
    setText(this.text, `${runs.length === 1 ? "one run" : `${runs.length} runs`}, first ${age(runs.at(-1).created_at)}`);
    this.cell.colSpan = columns.length + 2 + n;
  }
}

// What a row shows of a study: [{ study, isOpen }, { run, study } ..., { more }].
async function groupOf(study, isOpen, options) {
  if (!isOpen) return [{ study, isOpen }];
  const { runs, cursor } = await listRuns({ study: study.id, limit: LIMIT }, options);
  const more = { href: address("runs", "", { study: study.id }), text: "Show all its runs" };
  return [{ study, isOpen }, ...runs.map((run) => ({ run, study })), ...(cursor === null ? [] : [{ more }])];
}

// A page of the runs of a line by its versions, the greatest first, [{ version }, { run } ...]; before the first page the line's
// studies. open: as of grouped().
export async function byVersion(runs, { line, owner, after, open }, options) {
  const { studies } = after ? { studies: [] } : await listStudies({ line, owner, limit: LIMIT }, options);
  const groups = await Promise.all(studies.map((study) => groupOf(study, open.includes(study.id), options)));
  const numbers = [...new Set(runs.map((run) => run.line_version))].sort((a, b) => b - a);
  const versions = numbers.flatMap((number) => {
    const its = runs.filter((run) => run.line_version === number);
    return [{ version: { id: `version-${number}-${its[0].id}`, number, runs: its } }, ...its.map((run) => ({ run }))];
  });
  return [...groups.flat(), ...versions];
}

// A page of single runs, [{ run }], with the studies of its time between them, newest first, which ids sort by, too. after: the
// run behind which the page begins; open: the ids of studies that show their runs; search: what their names contain.
export async function grouped({ runs, cursor }, { after, open, search }, options) {
  const page = await listStudies({ limit: LIMIT, cursor: after }, options);
  const oldest = cursor === null ? "" : runs.at(-1).id;
  const studies = page.studies.filter((study) => study.id > oldest && nameOfStudy(study).toLowerCase().includes(search.toLowerCase()));
  const groups = await Promise.all(studies.map((study) => groupOf(study, open.includes(study.id), options)));
  const idOf = ([{ run, study }]) => (study ?? run).id;
  const entries = [...runs.map((run) => [{ run }]), ...groups].sort((a, b) => (idOf(a) < idOf(b) ? 1 : -1)).flat();
  const isCut = page.cursor !== null && page.studies.at(-1).id > oldest;
  return isCut ? [...entries, { more: { href: address("studies", "", { cursor: page.cursor }), text: "Show older studies" } }] : entries;
}
