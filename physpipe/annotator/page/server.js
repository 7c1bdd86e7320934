// Questions to the server. What it refuses, it says in one sentence, which the page shows as it is.

const ANSWER_MS = 15000;

export class Refused extends Error {
  constructor(code, answer) {
    super(answer.error ?? `the server answered ${code}`);
    Object.assign(this, { code, answer });
  }
}

export async function ask(path, method = "GET", body = undefined, patience = ANSWER_MS) {
  const headers = body === undefined ? {} : { "Content-Type": "application/json" };
  const signal = AbortSignal.timeout(patience);
  const response = await fetch(`api/${path}`, { method, headers, body: body && JSON.stringify(body), signal });
  const answer = await response.json().catch(() => ({}));
  if (!response.ok) throw new Refused(response.status, answer);
  return answer;
}

export async function askForPicture(clip, number) {
  const response = await fetch(`api/${clipPath(clip, "frames", number)}`);
  return createImageBitmap(await response.blob(), { colorSpaceConversion: "none" });
}

export const clipPath = (name, ...rest) => ["clips", encodeURIComponent(name), ...rest].join("/");
