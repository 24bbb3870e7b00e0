// The one connection to the console's server. It comes back by itself when the server has gone and is there again.

const FIRST_WAIT_MS = 300;
const LONGEST_WAIT_MS = 3000;
const REFUSED = 1008;

/** The secret behind the # of the address; it is kept for this tab and taken out of the address bar. */
function token() {
  const given = new URLSearchParams(location.hash.slice(1)).get("token");
  if (given) {
    sessionStorage.setItem("token", given);
    history.replaceState(null, "", location.pathname);
  }
  return sessionStorage.getItem("token") ?? "";
}

/** Calls `heard` with every message, `told` with how the connection does; returns what sends a message. */
export function connect(heard, told) {
  const secret = token();
  let socket = null;
  let waitMs = FIRST_WAIT_MS;

  function open() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    socket = new WebSocket(`${scheme}://${location.host}/run`);
    socket.onopen = () => {
      waitMs = FIRST_WAIT_MS;
      socket.send(JSON.stringify({ token: secret }));
      told("");
    };
    socket.onmessage = (event) => heard(JSON.parse(event.data));
    socket.onclose = (event) => {
      if (event.code === REFUSED && event.reason) {
        told(event.reason);
        return;
      }
      told("the console's server is gone: waiting for it");
      setTimeout(open, waitMs);
      waitMs = Math.min(LONGEST_WAIT_MS, waitMs * 2);
    };
  }

  open();
  return (words) => {
    if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(words));
  };
}
