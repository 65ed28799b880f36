// A reader of server-sent events that follows their grammar exactly and exposes everything: ids,
// comments and an incomplete end.

import http from "node:http";

import { checkEvent, checkStream, noteStream } from "./contract.mjs";

const FIRST = 1500; // characters of a stream, for an example

export class EventStream {
  // Resolves with the stream once the response's head is there.
  static open(port, target, headers = {}) {
    return new Promise((resolve, reject) => {
      const request = http.request(
        { host: "127.0.0.1", port, path: target, headers, agent: false },
        (response) => {
          try {
            checkStream(target, response.statusCode, response.headers);
            resolve(new EventStream(request, response, target));
          } catch (error) {
            request.destroy();
            reject(error);
          }
        },
      );
      request.on("error", reject);
      request.end();
    });
  }

  constructor(request, response, target) {
    this.request = request;
    this.target = target;
    this.status = response.statusCode;
    this.headers = response.headers;
    this.comments = 0;
    this.retry = null;
    this.isTorn = false;
    this.lastId = null;
    request.on("error", () => (this.isTorn = true));
    this.source = this.parse(response);
  }

  async *lines(response) {
    let rest = "";
    response.setEncoding("utf8");
    try {
      for await (const chunk of response) {
        const parts = (rest + chunk).split("\n");
        rest = parts.pop();
        yield* parts;
      }
    } catch {
      this.isTorn = true;
    }
  }

  async *parse(response) {
    let event = {};
    let first = "";
    for await (const line of this.lines(response)) {
      if (first.length < FIRST) {
        first += `${line}\n`;
        if (first.length >= FIRST) noteStream(this.target, this.headers, first);
      }
      if (line === "") {
        const whole = event.data === undefined ? null : { ...event, data: JSON.parse(event.data) };
        event = {};
        if (whole === null) continue;
        checkEvent(whole, this.target);
        yield whole;
      } else if (line.startsWith(":")) {
        this.comments += 1;
      } else {
        const [, field, value] = /^(\w+): ?(.*)$/.exec(line);
        if (field === "retry") this.retry = Number(value);
        else if (field === "data" && event.data !== undefined) event.data += `\n${value}`;
        else event[field] = value;
      }
    }
  }

  // The next event, or null at the end of the stream.
  async next() {
    const { value, done } = await this.source.next();
    if (done) return null;
    this.lastId = value.id ?? this.lastId;
    return value;
  }

  // The next event of this kind (one that is passed over is gone), or null at the end.
  async until(kind) {
    for (;;) {
      const event = await this.next();
      if (event === null || event.event === kind) return event;
    }
  }

  // Every event that is still to come.
  async rest() {
    const events = [];
    for (let event = await this.next(); event !== null; event = await this.next()) {
      events.push(event);
    }
    return events;
  }

  // Disconnect.
  close() {
    this.request.destroy();
  }
}
