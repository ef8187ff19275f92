// Requests to the program.

export const token = location.hash.slice(1);
export const tab = crypto.randomUUID();

export async function post(name, values, signal) {
  const response = await fetch(`api/${name}`, {
    method: "POST", signal, body: JSON.stringify(values),
    headers: { "Content-Type": "application/json", "X-Token": token },
  });
  if (!response.ok) throw new Error((await response.text()) || `request refused (${response.status})`);
  return response;
}

export async function stream(name, values, signal, take) {
  const response = await post(name, values, signal);
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  for (let rest = ""; ;) {
    const { value, done } = await reader.read();
    if (done) return;
    const lines = (rest + value).split("\n");
    rest = lines.pop();
    for (const line of lines) take(JSON.parse(line));
  }
}

export const lostServer = (error) => (error instanceof TypeError ? "the program does not answer: start restitution app again" : error.message);
